package rubric.basestation;

import java.nio.ByteBuffer;
import java.util.ArrayDeque;
import java.util.ArrayList;
import java.util.Deque;
import java.util.List;
import java.util.Optional;
import java.util.OptionalInt;
import java.util.OptionalLong;
import rubric.wire.Wire;
import rubric.wire.WireException;
import rubric.wire.rubicon.AmType;
import rubric.wire.rubicon.AppMsg;
import rubric.wire.rubicon.Component;
import rubric.wire.rubicon.Devid;
import rubric.wire.rubicon.NetMsg;
import rubric.wire.rubicon.Pid;

/**
 * The base station of an island: its application talks with the motes of its island through the
 * sink on the serial line, and with other islands through PEIS.
 *
 * <p>No socket and no clock: its driver passes in events and times, in ticks of 1/1024 s
 * that never go back, and does what it returns, in that order. When due() comes, call timeout().
 */
public final class BaseStation {
  /** Time for the ack of a reliable message; our own parameter. (decision 110) */
  public static final long ACK_TIMEOUT_TICKS = 1000;

  private static final int TICKS_PER_SECOND = 1024;

  private final int firstIsland;
  private final SequenceNumbers numbers;
  private List<Action> actions = new ArrayList<>();
  // Memory, lost without power.
  private int island;
  private AwaitedAcks awaited;
  private SerialLine serial;
  private Deque<NetMsg> undelivered;
  // Not the station's.
  private boolean serialTaken = false;
  private boolean appBusy = false;
  private boolean off = false;
  private long start = 0;

  /** A station that has just started. */
  public BaseStation(int island, int firstSeqNum) {
    firstIsland = island;
    numbers = new SequenceNumbers(firstSeqNum);
    loseMemory();
  }

  public Address address() {
    return new Address(island, Devid.NULL);
  }

  /** When the first timeout expires. */
  public OptionalLong due() {
    return awaited.due();
  }

  /** Time passed until `now`. */
  public List<Action> timeout(long now) {
    actions.addAll(awaited.expire(now));
    return done(now);
  }

  /** A line brought a frame, whoever it is for. */
  public List<Action> hear(Frame frame, long now) {
    final boolean here = frame.link() == Link.SERIAL && serial.isOn()
        || frame.link() == Link.PEIS && frame.dest() == island;
    if (off || !here || frame.type() != AmType.NET) return done(now);
    final NetMsg message;
    try {
      message = NetMsg.parse(ByteBuffer.wrap(frame.payload()));
    } catch (WireException e) {
      //= N11-NBYTES: A net_msg whose nbytes is over 102, under 2, or more than arrived is dropped:
      //= no delivery, no ack, no forward.
      //= T2-TWO: A message whose reliable is neither 0 nor 1 is not acked.
      return done(now);
    }
    final Router router = new Router(island);
    final Address dest = Address.of(message.dest());
    //= N8-INCOMING: A base station hands a message from PEIS for a mote of its island to its sink
    //= with addresses, reliable, sequence number and payload kept.
    router.ofReceived(frame.link(), dest).ifPresent(
        hop -> put(hop, AmType.NET, Wire.copy(message.bytes()), SequenceNumbers.NONE, hop.rule()));
    if (router.isForUs(dest)) undelivered.add(message);
    return done(now);
  }

  /** Connectionless.send. */
  public List<Action> send(Address dest, int appId, boolean reliable, byte[] data, long now) {
    if (off) return done(now);
    final OptionalInt seqNum = sendOwn(dest, Component.CONNLESS, appId, reliable, data, "");
    //= N1-SEQ: send returns the sequence number that the message carries.
    actions.add(new Action.SendResult(seqNum.orElse(SequenceNumbers.NONE), "N1-SEQ"));
    return done(now);
  }

  /** Changes the island's id, and sends it to the sink. */
  public List<Action> setIslandId(int id, long now) {
    if (off) return done(now);
    final boolean sound = !Address.isReserved(id) && serial.takes();
    if (sound) {
      put(new Router.Hop(Link.SERIAL, Router.SINK, "N9-SET"), AmType.CONFIG,
          Messages.setIslandId(id), SequenceNumbers.NONE, "N9-SET");
      island = id;
    }
    actions.add(new Action.OperationResult(sound, "N9-SET"));
    return done(now);
  }

  /** Switches the serial interface on or off; there is no other. */
  public List<Action> setInterface(Link link, boolean on, long now) {
    if (off) return done(now);
    if (link == Link.SERIAL) serial.setOn(on);
    actions.add(new Action.OperationResult(link == Link.SERIAL, "N10-STATE"));
    return done(now);
  }

  public List<Action> getInterface(Link link, long now) {
    if (off) return done(now);
    final boolean on = link == Link.SERIAL ? serial.isOn() : link == Link.PEIS;
    actions.add(new Action.InterfaceState(link, on, "N10-STATE"));
    return done(now);
  }

  public List<Action> getClock(long now) {
    if (off) return done(now);
    actions.add(new Action.Clock((now - start) * 1000 / TICKS_PER_SECOND, "J4-CLOCK"));
    return done(now);
  }

  /** joinIsland: it is where it belongs, for good. */
  public List<Action> join(long now) {
    if (off) return done(now);
    actions.add(new Action.Joined(address(), false, "J8-JOINED"));
    return done(now);
  }

  /** Refuses a call of synaptic channels with this answer. (decision 135) */
  public List<Action> refuseChannels(String answer, long now) {
    if (off) return done(now);
    actions.add(new Action.NoChannels(answer, ""));
    return done(now);
  }

  /** Somebody else takes the serial line, or leaves it. */
  public List<Action> serialTaken(boolean taken, long now) {
    serialTaken = taken;
    serial.setTaken(taken);
    return done(now);
  }

  /** The application takes no messages, or takes them again. */
  public List<Action> appBusy(boolean busy, long now) {
    appBusy = busy;
    return done(now);
  }

  /** Power goes, until reboot. */
  public List<Action> powerOff(long now) {
    off = true;
    loseMemory();
    return done(now);
  }

  /** Starts again. Sequence numbers go on, so that late acks do not fit the next messages. */
  public List<Action> reboot(long now) {
    off = false;
    appBusy = false;
    start = now;
    loseMemory();
    return done(now);
  }

  private void loseMemory() {
    island = firstIsland;
    awaited = new AwaitedAcks(ACK_TIMEOUT_TICKS);
    serial = new SerialLine();
    serial.setTaken(serialTaken);
    undelivered = new ArrayDeque<>();
  }

  /** Passes on what can be passed on; then outputs leave, and timeouts begin. */
  private List<Action> done(long now) {
    while (!appBusy && !undelivered.isEmpty()) deliver(undelivered.remove());
    actions.addAll(serial.leaving());
    final List<Action> out = actions;
    actions = new ArrayList<>();
    for (final Action action : out) {
      // A message's timeout counts from when the line has it.
      if (action instanceof Action.Transmit) awaited.left(((Action.Transmit) action).awaits(), now);
    }
    return out;
  }

  /** Puts a message on a line, or queues it for the serial line. */
  private void put(Router.Hop hop, int type, byte[] payload, int awaits, String rule) {
    if (hop.link() == Link.PEIS) {
      final Frame frame = new Frame(Link.PEIS, hop.dest(), island, type, payload);
      actions.add(new Action.Transmit(frame, awaits, rule));
      return;
    }
    final byte[] whole = type == AmType.NET ? Messages.padded(payload) : payload;
    final Frame frame = new Frame(Link.SERIAL, hop.dest(), 0, type, whole);
    serial.put(new Action.Transmit(frame, awaits, rule));
  }

  /** Sends a message of the station itself; none where it is refused. `rule`: why, if not send. */
  private OptionalInt sendOwn(Address to, int transId, int appId, boolean reliable, byte[] data,
      String rule) {
    //= N1-SIZE: send refuses more than 100 bytes of application data.
    if (data.length > Messages.DATA_MAX) return OptionalInt.empty();
    //= N3-LOCAL: dest.pid 0xFFFE (local island) is replaced by the sender's own island before the
    //= message is sent.
    final Address dest = to.pid() == Pid.LOCAL ? new Address(island, to.devid()) : to;
    final Optional<Router.Hop> hop = new Router(island).ofOwn(dest);
    if (hop.isEmpty()) return OptionalInt.empty();
    if (hop.get().link() == Link.SERIAL && !serial.takes()) return OptionalInt.empty();
    if (reliable && awaited.isFull()) return OptionalInt.empty();
    final int seqNum = numbers.take(awaited::contains);
    if (reliable) awaited.add(seqNum, dest, appId);
    //= N1-SRC: What a node sends on behalf of its applications carries the node's own address as
    //= src; a base station's src is <its island, NULL>.
    final byte[] message =
        Messages.netMsg(dest, address(), reliable, seqNum, transId, appId, data);
    final int awaits = reliable ? seqNum : SequenceNumbers.NONE;
    put(hop.get(), AmType.NET, message, awaits, rule.isEmpty() ? hop.get().rule() : rule);
    return OptionalInt.of(seqNum);
  }

  /** The message dispatcher. */
  private void deliver(NetMsg message) {
    final AppMsg app;
    try {
      app = AppMsg.parse(message.payload());
    } catch (WireException e) {
      throw new IllegalStateException(e); // It was checked with the whole.
    }
    final Address src = Address.of(message.src());
    if (app.transId() == Component.RUBICON_ACK) {
      //= T2-LOOP: An ack is never acked.
      Messages.acked(app).ifPresent(seqNum ->
          awaited.heard(src, app.appId(), seqNum).ifPresent(actions::add));
      return;
    }
    //= T1-UNKNOWN: A message with an unknown TRANSID or APPID is dropped without harm.
    if (app.transId() != Component.CONNLESS || !Messages.isApplication(app.appId())) return;
    final boolean reliable = message.reliable() == 1;
    //= T1-DELIVER: The receiver takes TRANSID and APPID off and hands the rest and the source to
    //= the application that APPID names.
    actions.add(new Action.Received(src, app.appId(), Wire.copy(app.payload()),
        reliable ? "T2-DELIVER" : "T1-DELIVER"));
    //= T2-BROADCAST: A broadcast is not acked.
    if (!reliable || !Address.of(message.dest()).equals(address())) return;
    //= T2-CONTENT: An ack has TRANSID RUBICON_ACK, the APPID and the sequence number of a message
    //= to the node itself, is unreliable, and goes to the message's source.
    sendOwn(src, Component.RUBICON_ACK, app.appId(), false, Messages.ack(message.seqNum()),
        "T2-ACK");
  }
}
