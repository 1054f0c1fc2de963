"""The ns-3 side: reads one run as a JSON line, simulates it, answers with a JSON line, until stdin ends.

Run by an interpreter that has the wheel of ns-3 3.44 (`pip install ns3==3.44`); needs nothing of Onehop.
What it is told: mean SNR of every pair, thresholds over the noise, rates, flows (cases.py). Propagation
is a matrix of losses, so both simulators have the same SNR.

ns-3 takes the noise of a DSSS receiver over 20 MHz, not 22 (DsssPhy::GetRxChannelWidth); its noise
figure is set so that the floor is the same. Responses are sent at 1 Mb/s, the one rate of the basic set.
"""

import json
import math
import sys
import time
from pathlib import Path

import cppyy
from ns import ns

TX_POWER_DBM = 20.0
NOISE_DBM = -77.0
SILENT_DB = 500.0
"""Loss where there is no path at all [dB]."""
BOLTZMANN = 1.3803e-23
"""As ns-3 has it [J/K]."""
QUEUE_FRAMES = 64
AODV = {"aodv": False, "aodv with hellos": True}
"""Whether AODV sends hello messages (RFC 3561, 6.9), by protocol."""
ROUTING_START_S = 1.0
"""Routing protocols have started by then; messages are sent from then on [s]."""


def decibels(loss, nodes, snr_db):
    """Losses between all pairs that give the mean SNRs; None: no path."""
    places = [nodes.Get(i).GetObject[ns.MobilityModel]() for i in range(len(snr_db))]
    for i, row in enumerate(snr_db):
        for j in range(i):
            if row[j] is not None:
                loss.SetLoss(places[i], places[j], TX_POWER_DBM - NOISE_DBM - row[j], True)


def channel(nodes, run):
    """The medium, and its matrix of losses."""
    loss = ns.CreateObject[ns.MatrixPropagationLossModel]()
    loss.SetDefaultLoss(SILENT_DB)
    decibels(loss, nodes, run["snr_db"])
    if run["fading_db"]:
        normal = ns.CreateObject[ns.NormalRandomVariable]()
        normal.SetAttribute("Variance", ns.DoubleValue(run["fading_db"] ** 2))
        fading = ns.CreateObject[ns.RandomPropagationLossModel]()
        fading.SetAttribute("Variable", ns.PointerValue(normal))
        loss.SetNext(fading)
    medium = ns.CreateObject[ns.YansWifiChannel]()
    medium.SetPropagationLossModel(loss)
    medium.SetPropagationDelayModel(ns.CreateObject[ns.ConstantSpeedPropagationDelayModel]())
    return medium, loss


def phy(medium, run):
    """A receiver that detects a preamble at the receive threshold and is then locked on that frame."""
    helper = ns.YansWifiPhyHelper()
    helper.SetChannel(medium)
    thermal_dbm = 10.0 * math.log10(BOLTZMANN * 290.0 * 20e6 * 1000.0)
    for name, value in (
        ("TxPowerStart", TX_POWER_DBM),
        ("TxPowerEnd", TX_POWER_DBM),
        ("RxNoiseFigure", NOISE_DBM - thermal_dbm),
        ("RxSensitivity", NOISE_DBM + run["reach_db"]),
        ("CcaEdThreshold", NOISE_DBM + run["carrier_sense_db"]),
        ("CcaSensitivity", NOISE_DBM + run["carrier_sense_db"]),
    ):
        helper.Set(name, ns.DoubleValue(value))
    helper.SetPreambleDetectionModel(
        "ns3::ThresholdPreambleDetectionModel",
        "Threshold",
        ns.DoubleValue(run["preamble_sinr_db"]),
        "MinimumRssi",
        ns.DoubleValue(NOISE_DBM + run["receive_threshold_db"]),
    )
    return helper


def stations(run):
    """Nodes at their places with 802.11b devices in ad hoc mode."""
    nodes = ns.NodeContainer()
    nodes.Create(len(run["places"]))
    positions = ns.CreateObject[ns.ListPositionAllocator]()
    for x, y in run["places"]:
        positions.Add(ns.Vector(x, y, 0.0))
    mobility = ns.MobilityHelper()
    mobility.SetPositionAllocator(positions)
    mobility.SetMobilityModel("ns3::ConstantPositionMobilityModel")
    mobility.Install(nodes)
    wifi = ns.WifiHelper()
    wifi.SetStandard(ns.WIFI_STANDARD_80211b)
    mode = f"DsssRate{run['rate_mbps']:g}Mbps".replace(".", "_")
    wifi.SetRemoteStationManager(
        "ns3::ConstantRateWifiManager",
        "DataMode",
        ns.StringValue(mode),
        "ControlMode",
        ns.StringValue("DsssRate1Mbps"),
        "NonUnicastMode",
        ns.StringValue("DsssRate1Mbps"),
        "RtsCtsThreshold",
        ns.UintegerValue(run["rts_threshold_bytes"]),
    )
    mac = ns.WifiMacHelper()
    mac.SetType("ns3::AdhocWifiMac")
    medium, loss = channel(nodes, run)
    devices = wifi.Install(phy(medium, run), mac, nodes)
    cppyy.gbl.onehop.AnswerAtOneMbps(devices)
    return nodes, devices, loss


def network(nodes, devices, run):
    """IP with AODV or DSR above the devices."""
    internet = ns.InternetStackHelper()
    if run["protocol"] in AODV:
        aodv = ns.AodvHelper()
        aodv.Set("EnableHello", ns.BooleanValue(AODV[run["protocol"]]))
        internet.SetRoutingHelper(aodv)
    internet.Install(nodes)
    addresses = ns.Ipv4AddressHelper()
    addresses.SetBase(ns.Ipv4Address("10.0.0.0"), ns.Ipv4Mask("255.255.255.0"))
    interfaces = addresses.Assign(devices)
    keep = [internet]
    if run["protocol"] == "dsr":
        main, dsr = ns.DsrMainHelper(), ns.DsrHelper()
        main.Install(dsr, nodes)
        keep += [main, dsr]
    cppyy.gbl.onehop.KnowAddresses(nodes, devices, interfaces)
    return interfaces, keep


def simulate(seconds):
    """Run to the end; the processor time that it took [s]."""
    ns.Simulator.Stop(ns.Seconds(seconds))
    begin = time.process_time()
    ns.Simulator.Run()
    return time.process_time() - begin


def flows(run):
    """Saturated flows, or periodic ones."""
    _nodes, devices, _loss = stations(run)
    traffic = cppyy.gbl.onehop.Stations(devices, run["msdu_bytes"])
    for path in run["paths"]:
        hops = cppyy.gbl.std.vector["uint32_t"](path)
        if run["period_s"]:
            traffic.SendEvery(hops, run["period_s"], run["seconds"])
        else:
            traffic.Saturate(hops)
    cpu_s = simulate(run["seconds"])
    result = {
        "received": [int(n) for n in traffic.received],
        "delays_ms": [[float(d) for d in flow] for flow in traffic.delays_ms],
        "cpu_s": cpu_s,
    }
    ns.Simulator.Destroy()
    return result


def messages(run):
    """Messages over a routing protocol: what the case offers, and when each arrived."""
    nodes, devices, loss = stations(run)
    interfaces, _keep = network(nodes, devices, run)
    traffic = cppyy.gbl.onehop.Messages(nodes, interfaces, run["msdu_bytes"])
    for at_s, source, destination in run["messages"]:
        traffic.SendAt(ROUTING_START_S + at_s, source, destination)
    for station, at_s in run["leaves"]:
        cppyy.gbl.onehop.LeaveAt(ROUTING_START_S + at_s, loss, nodes, station, SILENT_DB)
    cpu_s = simulate(ROUTING_START_S + run["seconds"])
    result = {
        "arrivals_s": [a - ROUTING_START_S if a >= 0.0 else None for a in traffic.arrivals_s],
        "routing_bytes": int(traffic.routing_bytes),
        "source_route_bytes": int(traffic.source_route_bytes),
        "cpu_s": cpu_s,
    }
    ns.Simulator.Destroy()
    return result


def main():
    cppyy.cppdef(Path(__file__).with_name("ns3_stations.cc").read_text())
    ns.Config.SetDefault("ns3::WifiMacQueue::MaxDelay", ns.TimeValue(ns.Seconds(1e6)))
    ns.Config.SetDefault(
        "ns3::WifiMacQueue::MaxSize", ns.QueueSizeValue(ns.QueueSize(f"{QUEUE_FRAMES}p"))
    )
    for line in sys.stdin:
        run = json.loads(line)
        ns.RngSeedManager.SetRun(run["seed"])
        ns.RngSeedManager.ResetNextStreamIndex()  # a run is the same whatever ran before it
        ns.Mac48Address.ResetAllocationIndex()
        simulated = messages(run) if run["protocol"] else flows(run)
        print(json.dumps(simulated), flush=True)


if __name__ == "__main__":
    main()
