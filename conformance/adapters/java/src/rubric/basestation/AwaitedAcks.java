package rubric.basestation;

import java.util.ArrayList;
import java.util.Iterator;
import java.util.LinkedHashMap;
import java.util.List;
import java.util.Map;
import java.util.Optional;
import java.util.OptionalLong;

/** Reliable messages that await their acks. Several may. (paper: Rubicon ACK) */
final class AwaitedAcks {
  /** Far more than a station has under way at once, far fewer than there are numbers. */
  private static final int ROOM = 1024;

  /** A message, and when its time is over: null until it has left. */
  private static final class Awaited {
    final Address dest;
    final int appId;
    Long due;

    Awaited(Address dest, int appId) {
      this.dest = dest;
      this.appId = appId;
    }
  }

  private final long timeoutTicks;
  private final Map<Integer, Awaited> bySeqNum = new LinkedHashMap<>();

  AwaitedAcks(long timeoutTicks) {
    this.timeoutTicks = timeoutTicks;
  }

  boolean isFull() {
    return bySeqNum.size() >= ROOM;
  }

  boolean contains(int seqNum) {
    return bySeqNum.containsKey(seqNum);
  }

  void add(int seqNum, Address dest, int appId) {
    bySeqNum.put(seqNum, new Awaited(dest, appId));
  }

  /** The message is on its line; its timeout begins. Other numbers are nobody's. */
  void left(int seqNum, long now) {
    final Awaited awaited = bySeqNum.get(seqNum);
    if (awaited != null) awaited.due = now + timeoutTicks;
  }

  /** An ack came: whether it ends a message. */
  Optional<Action> heard(Address from, int appId, int seqNum) {
    final Awaited awaited = bySeqNum.get(seqNum);
    //= T3-MATCH: An ack whose sequence number is that of no message awaiting its ack changes
    //= nothing.
    if (awaited == null) return Optional.empty();
    //= T3-SENDER: An ack counts only if it comes from the message's destination and carries its
    //= APPID.
    if (!awaited.dest.equals(from) || awaited.appId != appId) return Optional.empty();
    //= T4-SEVERAL: Several reliable messages may await their acks at once; each ack ends the
    //= message it names.
    bySeqNum.remove(seqNum);
    return Optional.of(new Action.AckReceived(appId, seqNum, true, "T3-SUCCESS"));
  }

  /** When the first timeout expires. */
  OptionalLong due() {
    return bySeqNum.values().stream().filter(a -> a.due != null).mapToLong(a -> a.due).min();
  }

  /** Ends all messages whose time is over. */
  List<Action> expire(long now) {
    final List<Action> out = new ArrayList<>();
    final Iterator<Map.Entry<Integer, Awaited>> all = bySeqNum.entrySet().iterator();
    while (all.hasNext()) {
      final Map.Entry<Integer, Awaited> one = all.next();
      final Awaited awaited = one.getValue();
      //= T3-TIMEOUT: A reliable message without its ack is signalled as receive_ack(failure) when
      //= its timeout expires, not before.
      if (awaited.due == null || awaited.due > now) continue;
      out.add(new Action.AckReceived(awaited.appId, one.getKey(), false, "T3-TIMEOUT"));
      all.remove();
    }
    return out;
  }
}
