"""A log that may still be written: opened when it is there, and followed as it grows.

The recorder flushes its file every few ticks, so whoever reads the file sees a running mission without
asking anybody for anything: the mission does not know that it is watched.
"""

from pathlib import Path

from mcap.opcode import Opcode

from onehop.analysis.log import Log
from onehop.contracts.errors import LogError
from onehop.wire.contents import Stretch, read_contents, records_of
from onehop.wire.log_reader import LogFile
from onehop.wire.log_writer import LOG_EPOCH_NS
from onehop.wire.records import channel, records_in


class GrowingLog:
    """One log. log: what it is by now, None until there is one.

    file_number: how many files of this name there have been. older_ns: when a file of the same name was
    written last that is none of this mission's.
    """

    def __init__(self, path: Path, older_ns: int | None = None) -> None:
        self.path = path
        self.log: Log | None = None
        self._older_ns = older_ns
        self._inode = 0
        self.file_number = 0

    @property
    def last_tick(self) -> int:
        """The last tick that can be read, -1 for none."""
        stretches = self.log.file.contents.stretches if self.log else ()
        last_ns = stretches[-1].last_ns if stretches else 0
        return (last_ns - LOG_EPOCH_NS) // self.log.period_ns if self.log and last_ns else -1

    def open(self) -> None:
        """Raises LogError when it is no log of ours."""
        inode = self.path.stat().st_ino if self.path.exists() else 0
        if inode != self._inode:
            self._inode = inode
            self.file_number += 1
        file = LogFile(self.path)
        _know_channels(file, file.contents.stretches)
        self.log = Log(file)

    def grow(self) -> bool:
        """Take in what has been written since; whether that was anything. Raises LogError."""
        if self.log is None:
            return self._appear()
        try:
            found = self.path.stat()
        except OSError:  # deleted, or being replaced: what is known stays
            return False
        contents = self.log.file.contents
        if found.st_ino != self._inode:
            self.open()
            return True
        if not self.log.torn or found.st_size <= contents.end:
            return False
        more = read_contents(self.path, contents.end)
        if more.end == contents.end:
            return False
        if more.torn:
            _know_channels(self.log.file, more.stretches)
            contents.stretches += more.stretches
            contents.end = more.end
        else:
            self.open()
        return True

    def _appear(self) -> bool:
        """Open it as soon as it is there and has what comes before its first tick."""
        try:
            if self.path.stat().st_mtime_ns == self._older_ns:
                return False
            self.open()
        except (OSError, LogError):
            self.log = None
            return False
        return True


def _know_channels(file: LogFile, stretches: list[Stretch]) -> None:
    """Note the channels that a file without its summary has: then it can be read from any tick on."""
    contents = file.contents
    if not contents.torn or not stretches:
        return
    known = {one.id for one in contents.channels}
    with file.path.open("rb") as stream:
        for stretch in stretches:
            if len(known) >= len(file.wire.keys):
                return
            data = records_of(stretch, stream)
            for opcode, begin, end in records_in(data):
                if opcode == Opcode.CHANNEL:
                    one = channel(data[begin:end])
                    if one.id not in known:
                        known.add(one.id)
                        contents.channels.append(one)
