"""One page that looks on: it asks for a frame, and is sent what is new with it when there is any.

Nothing is sent that was not asked for, and a page asks again when it has drawn: a slow browser gets
fewer frames, each the newest, and holds up nobody.
"""

import asyncio
from typing import Any

import msgspec
from starlette.websockets import WebSocket, WebSocketDisconnect

from onehop.analysis.report.narrative import NarrativeEvent
from onehop.contracts.errors import DecodeError, LogError
from onehop.contracts.operation import Pace
from onehop.contracts.printable import json_value, printable
from onehop.live.again import command, lines
from onehop.live.first_difference import FirstDifference
from onehop.live.hand import Hand
from onehop.live.requests import (
    NEWEST,
    AnyRequest,
    Explain,
    Order,
    RoadMap,
    SetPace,
    TakeOver,
    Want,
    decode_request,
    fault_of,
)
from onehop.live.source import Source
from onehop.live.story import CHARTS
from onehop.live.watchers import Watchers

FRAME_S = 1.0 / 15.0
"""Least time between two frames [s]: 15 a second look smooth, since the page moves robots in between."""

EVENTS_S = 0.25
"""Least time between two looks at the narrative [s]: a team in trouble notes something every tick."""

MOST_SAMPLES = 400
"""Points of the charts that are sent at once."""

NOT_YOURS = "somebody else has the buttons; take over first"

_encode = msgspec.json.Encoder().encode


class Viewer:
    """A page and the log that it looks at. hand: on the mission that runs, None for a log.

    difference: of two logs, the other of which another page's half looks at.
    """

    def __init__(
        self,
        socket: WebSocket,
        source: Source,
        watchers: Watchers["Viewer"],
        hand: Hand | None,
        difference: FirstDifference | None,
    ) -> None:
        self._socket = socket
        self._source = source
        self._watchers = watchers
        self._hand = hand
        self._difference = difference
        self._want: Want | None = None
        self._stirred = asyncio.Event()
        self._sending = asyncio.Lock()
        self._tasks: set[asyncio.Task[None]] = set()
        self._sent: dict[str, Any] = {}
        self._narrative: list[NarrativeEvent] = []
        self._events: list[list[Any]] = []
        self._events_due_s = 0.0
        self._samples = 0

    def stir(self) -> None:
        """There may be something new."""
        self._stirred.set()

    async def serve(self) -> None:
        """Until the page goes."""
        self._watchers.join(self)
        self._start(self._answer_wants())
        try:
            while True:
                await self._take(await self._socket.receive_text())
        except (
            WebSocketDisconnect,
            RuntimeError,
            KeyError,
        ):  # gone; or no text, which pages do not send
            pass
        finally:
            self._watchers.leave(self)
            for task in self._tasks:
                task.cancel()
            await asyncio.gather(*self._tasks, return_exceptions=True)

    def _start(self, work: Any) -> None:
        task = asyncio.ensure_future(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _send(self, message: dict[str, Any]) -> None:
        async with self._sending:
            await self._socket.send_text(_encode(message).decode())

    async def _take(self, text: str) -> None:
        try:
            request = decode_request(text)
        except DecodeError as error:
            await self._send({"kind": "refused", "words": str(error)})
            return
        if isinstance(request, Want):
            self._want = request
            self.stir()
        else:
            self._start(self._carry_out(request))

    async def _carry_out(self, request: AnyRequest) -> None:
        if isinstance(request, Explain):
            told = await asyncio.to_thread(self._source.explain, request.robot, request.at_s)
            await self._send(
                {"kind": "explained", "robot": request.robot, "at_s": request.at_s, "lines": told}
            )
        elif isinstance(request, RoadMap):
            planned = await asyncio.to_thread(self._source.road_map, request.robot, request.tick)
            await self._send({"kind": "road map", "robot": request.robot, **planned})
        elif isinstance(request, TakeOver):
            self._watchers.give(self)
        elif isinstance(request, Order):
            done, words = await self._ordered(request)
            await self._send(
                {"kind": "answer", "number": request.number, "done": done, "words": printable(words)}
            )
        elif isinstance(request, SetPace) and self._hand and self._watchers.holder is self:
            self._hand.set_pace(Pace(request.ticks_per_s, request.paused, request.steps))
            self._watchers.stir()

    async def _ordered(self, order: Order) -> tuple[bool, str]:
        if self._hand is None:
            return False, "this is a log: what happened has happened"
        if self._watchers.holder is not self:
            return False, NOT_YOURS
        try:
            fault = fault_of(order)
        except DecodeError as error:
            return False, str(error)
        return await asyncio.to_thread(self._hand.order, fault)

    async def _answer_wants(self) -> None:
        while True:
            await self._stirred.wait()
            self._stirred.clear()
            want = self._want
            reply = None if want is None else self._reply(want)
            if reply is not None:
                self._want = None
                await self._send(reply)
                await asyncio.sleep(FRAME_S)

    def _reply(self, want: Want) -> dict[str, Any] | None:
        """What is new for this page; None if nothing is."""
        reply: dict[str, Any] = {}
        for name, value in (
            ("setting", self._source.setting()),
            ("state", self._source.state()),
            ("hand", self._of_hand()),
            ("again", self._again()),
            ("difference", self._difference and self._difference.found),
        ):
            if value is not None and self._sent.get(name) != value:
                self._sent[name] = value
                reply[name] = json_value(value)
        self._add_story(reply)
        last = self._source.last_tick
        tick = last if want.tick == NEWEST else min(want.tick, last)
        if tick not in (want.since, -1):
            try:
                shown = self._source.frame(tick, want.since, want.robot)
            except LogError as error:
                self._source.problem = printable(str(error))
                self.stir()
                shown = None
            if shown is not None:
                reply["frame"] = shown
        return {"kind": "news", **reply} if reply else None

    def _of_hand(self) -> dict[str, Any] | None:
        hand = self._hand
        if hand is None:
            return None
        return {
            "yours": self._watchers.holder is self,
            "viewers": len(self._watchers),
            "holds": hand.holds,
            "is_paced": hand.is_paced,
            "ticks_per_s": hand.pace.ticks_per_s,
            "paused": hand.pace.paused,
        }

    def _again(self) -> dict[str, Any] | None:
        """How this mission is run again; looked at anew only when a fault has begun."""
        story = self._source.story
        if story is None:
            return None
        begun = list(story.begun)
        before = self._sent.get("again")
        if before is not None and before["faults"] == len(begun):
            return None
        words = () if self._hand is None else self._hand.words
        return {
            "faults": len(begun),
            "command": command(words, story.scenario, begun) if words else "",
            "lines": lines(story.scenario, begun),
        }

    def _add_story(self, reply: dict[str, Any]) -> None:
        story = self._source.story
        if story is None:
            return
        names = [printable(name, 40) for name in story.names[:CHARTS]]
        if names != self._sent.get("names", []):
            self._sent["names"] = reply["names"] = names
        if len(story.samples) > self._samples:
            new = story.samples[self._samples : self._samples + MOST_SAMPLES]
            reply["samples"] = new
            self._samples += len(new)
        loop = asyncio.get_running_loop()
        if loop.time() < self._events_due_s:
            return
        self._events_due_s = loop.time() + EVENTS_S
        loop.call_later(EVENTS_S, self.stir)
        events = story.events()
        if events is self._narrative:
            return
        self._narrative = events
        told = [[round(e.at_s, 2), e.weight, printable(e.text, 600), e.robot] for e in events]
        same = 0
        for before, now in zip(self._events, told, strict=False):
            if before != now:
                break
            same += 1
        if same < max(len(told), len(self._events)):
            reply["events"] = {"from": same, "events": told[same:]}
            self._events = told
