// What ns-3 does for every frame or message, compiled by cppyy when ns3_worker.py starts: a callback into
// Python costs more than ns-3's own event.

#include <algorithm>
#include <array>
#include <vector>

using namespace ns3;

namespace onehop
{

// The first bytes of every payload: what it is.
using Label = std::array<uint32_t, 3>;

constexpr uint32_t LLC_BYTES = 8; // LLC/SNAP, part of the MSDU

inline Ptr<Packet>
Labelled(const Label& label, uint32_t bytes)
{
    std::vector<uint8_t> payload(bytes, 0);
    std::memcpy(payload.data(), label.data(), sizeof(Label));
    return Create<Packet>(payload.data(), bytes);
}

inline Label
LabelOf(Ptr<const Packet> packet, uint32_t offset)
{
    std::array<uint8_t, LLC_BYTES + sizeof(Label)> bytes{};
    packet->CopyData(bytes.data(), offset + sizeof(Label));
    Label label;
    std::memcpy(label.data(), bytes.data() + offset, sizeof(Label));
    return label;
}

// Stations without IP: saturated flows over static routes, or a message for everybody every period.
//
// A saturated source has BACKLOG frames and gets another one whenever one is acknowledged or dropped, so
// its backlog never ends. The service of a frame begins when it exists and the one before it is done.
class Stations
{
  public:
    std::vector<std::vector<double>> delays_ms; // by flow: from service at the source to arrival
    std::vector<uint32_t> received;             // MSDUs received, by transmitting station

    Stations(NetDeviceContainer devices, uint32_t msdu_bytes)
        : received(devices.GetN(), 0),
          m_devices(devices),
          m_bytes(msdu_bytes - LLC_BYTES)
    {
        for (uint32_t i = 0; i < devices.GetN(); ++i)
        {
            auto device = DynamicCast<WifiNetDevice>(devices.Get(i));
            using Receive = Callback<bool, Ptr<NetDevice>, Ptr<const Packet>, uint16_t, const Address&>;
            device->SetReceiveCallback(
                Receive([this](Ptr<NetDevice>, Ptr<const Packet> packet, uint16_t, const Address&) {
                    OnReceived(LabelOf(packet, 0));
                    return true;
                }));
            using Acked = Callback<void, Ptr<const WifiMpdu>>;
            device->GetMac()->TraceConnectWithoutContext(
                "AckedMpdu",
                Acked([this](Ptr<const WifiMpdu> mpdu) { OnServed(mpdu); }));
            using Dropped = Callback<void, WifiMacDropReason, Ptr<const WifiMpdu>>;
            device->GetMac()->TraceConnectWithoutContext(
                "DroppedMpdu",
                Dropped([this](WifiMacDropReason, Ptr<const WifiMpdu> mpdu) { OnServed(mpdu); }));
        }
    }

    void Saturate(std::vector<uint32_t> path)
    {
        uint32_t flow = AddFlow(path);
        m_saturated[flow] = true;
        for (int k = 0; k < BACKLOG; ++k)
        {
            Simulator::Schedule(MicroSeconds(1 + flow), &Stations::Offer, this, flow);
        }
    }

    void SendEvery(std::vector<uint32_t> path, double period_s, double until_s)
    {
        uint32_t flow = AddFlow(path);
        for (double at = 1e-6; at < until_s; at += period_s)
        {
            Simulator::Schedule(Seconds(at), &Stations::Offer, this, flow);
        }
    }

  private:
    static constexpr int BACKLOG = 3;

    uint32_t AddFlow(std::vector<uint32_t> path)
    {
        m_paths.push_back(path);
        m_service.emplace_back();
        m_saturated.push_back(false);
        delays_ms.emplace_back();
        return m_paths.size() - 1;
    }

    void Send(const Label& label)
    {
        const auto& path = m_paths[label[0]];
        auto receiver = m_devices.Get(path[label[1] + 1])->GetAddress();
        m_devices.Get(path[label[1]])->Send(Labelled(label, m_bytes), receiver, 0x88b5);
    }

    void Offer(uint32_t flow)
    {
        uint32_t number = m_service[flow].size();
        m_service[flow].push_back(Simulator::Now().GetSeconds());
        Send({flow, 0, number});
    }

    void OnServed(Ptr<const WifiMpdu> mpdu)
    {
        Label label = LabelOf(mpdu->GetPacket(), LLC_BYTES);
        auto [flow, hop, number] = label;
        if (hop == 0 && m_saturated[flow])
        {
            double& next = m_service[flow][number + 1];
            next = std::max(next, Simulator::Now().GetSeconds());
            Offer(flow);
        }
    }

    void OnReceived(Label label)
    {
        auto [flow, hop, number] = label;
        ++received[m_paths[flow][hop]];
        if (hop + 2 < m_paths[flow].size())
        {
            Send({flow, hop + 1, number});
        }
        else
        {
            double delay_s = Simulator::Now().GetSeconds() - m_service[flow][number];
            delays_ms[flow].push_back(1e3 * delay_s);
        }
    }

    NetDeviceContainer m_devices;
    uint32_t m_bytes;
    std::vector<std::vector<uint32_t>> m_paths;
    std::vector<std::vector<double>> m_service;
    std::vector<bool> m_saturated;
};

// UDP messages between nodes with a routing protocol, and what that protocol sends to carry them.
class Messages
{
  public:
    std::vector<double> arrivals_s; // by message, -1 while it has not arrived
    uint64_t routing_bytes = 0;      // of routing packets, each hop of each, IP header included
    uint64_t source_route_bytes = 0; // what DSR adds to each hop of a message

    Messages(NodeContainer nodes, Ipv4InterfaceContainer interfaces, uint32_t msdu_bytes)
        : m_interfaces(interfaces),
          m_bytes(msdu_bytes - LLC_BYTES - IP_BYTES - UDP_BYTES)
    {
        for (uint32_t i = 0; i < nodes.GetN(); ++i)
        {
            auto socket = Socket::CreateSocket(nodes.Get(i), UdpSocketFactory::GetTypeId());
            socket->Bind(InetSocketAddress(Ipv4Address::GetAny(), PORT));
            socket->SetRecvCallback(Callback<void, Ptr<Socket>>([this](Ptr<Socket> from) {
                while (auto packet = from->Recv())
                {
                    OnReceived(LabelOf(packet, 0)[0]);
                }
            }));
            m_sockets.push_back(socket);
            using Sent = Callback<void, Ptr<const Packet>, Ptr<Ipv4>, uint32_t>;
            nodes.Get(i)->GetObject<Ipv4L3Protocol>()->TraceConnectWithoutContext(
                "Tx",
                Sent([this](Ptr<const Packet> packet, Ptr<Ipv4>, uint32_t interface) {
                    OnSent(packet, interface);
                }));
        }
    }

    void SendAt(double at_s, uint32_t source, uint32_t destination)
    {
        uint32_t number = arrivals_s.size();
        arrivals_s.push_back(-1.0);
        Simulator::Schedule(Seconds(at_s), &Messages::Send, this, number, source, destination);
    }

  private:
    static constexpr uint32_t IP_BYTES = 20;
    static constexpr uint32_t UDP_BYTES = 8;
    static constexpr uint16_t PORT = 4000;
    static constexpr uint16_t AODV_PORT = 654;
    static constexpr uint8_t UDP = 17;
    static constexpr uint8_t DSR = 48;

    void Send(uint32_t number, uint32_t source, uint32_t destination)
    {
        auto to = InetSocketAddress(m_interfaces.GetAddress(destination), PORT);
        m_sockets[source]->SendTo(Labelled({number, 0, 0}, m_bytes), 0, to);
    }

    void OnReceived(uint32_t number)
    {
        if (arrivals_s[number] < 0.0)
        {
            arrivals_s[number] = Simulator::Now().GetSeconds();
        }
    }

    void OnSent(Ptr<const Packet> packet, uint32_t interface)
    {
        if (interface == 0) // a packet that AODV defers goes round the loopback
        {
            return;
        }
        const uint32_t message_bytes = IP_BYTES + UDP_BYTES + m_bytes;
        std::array<uint8_t, IP_BYTES + UDP_BYTES> header{};
        packet->CopyData(header.data(), header.size());
        const uint8_t protocol = header[9];
        const uint16_t port = (header[IP_BYTES + 2] << 8) | header[IP_BYTES + 3];
        if ((protocol == UDP && port == AODV_PORT) || (protocol == DSR && packet->GetSize() < message_bytes))
        {
            routing_bytes += packet->GetSize();
        }
        else if (protocol == DSR)
        {
            source_route_bytes += packet->GetSize() - message_bytes;
        }
    }

    Ipv4InterfaceContainer m_interfaces;
    uint32_t m_bytes;
    std::vector<Ptr<Socket>> m_sockets;
};

// Leave 1 Mb/s the only basic rate. A station that is known already does not get its peers' mandatory
// rates added to the basic set, and responses would be sent at those (802.11-1999, 9.6).
inline void
AnswerAtOneMbps(NetDeviceContainer devices)
{
    for (uint32_t i = 0; i < devices.GetN(); ++i)
    {
        auto manager = DynamicCast<WifiNetDevice>(devices.Get(i))->GetRemoteStationManager();
        manager->AddBasicMode(DsssPhy::GetDsssRate1Mbps());
        for (uint32_t j = 0; j < devices.GetN(); ++j)
        {
            if (j != i)
            {
                manager->RecordDisassociated(Mac48Address::ConvertFrom(devices.Get(j)->GetAddress()));
            }
        }
    }
}

// Every node knows every other one's MAC address: Onehop's radio has no ARP.
inline void
KnowAddresses(NodeContainer nodes, NetDeviceContainer devices, Ipv4InterfaceContainer interfaces)
{
    for (uint32_t i = 0; i < nodes.GetN(); ++i)
    {
        auto ip = nodes.Get(i)->GetObject<Ipv4L3Protocol>();
        auto cache = ip->GetInterface(interfaces.Get(i).second)->GetArpCache();
        for (uint32_t j = 0; j < nodes.GetN(); ++j)
        {
            if (j != i)
            {
                auto entry = cache->Add(interfaces.GetAddress(j));
                entry->SetMacAddress(devices.Get(j)->GetAddress());
                entry->MarkPermanent();
            }
        }
    }
}

// From now on nobody hears this station and it hears nobody.
inline void
Leave(Ptr<MatrixPropagationLossModel> loss, NodeContainer nodes, uint32_t station, double silent_db)
{
    for (uint32_t i = 0; i < nodes.GetN(); ++i)
    {
        if (i != station)
        {
            loss->SetLoss(nodes.Get(station)->GetObject<MobilityModel>(),
                          nodes.Get(i)->GetObject<MobilityModel>(),
                          silent_db,
                          true);
        }
    }
}

inline void
LeaveAt(double at_s, Ptr<MatrixPropagationLossModel> loss, NodeContainer nodes, uint32_t station, double silent_db)
{
    Simulator::Schedule(Seconds(at_s), &Leave, loss, nodes, station, silent_db);
}

} // namespace onehop
