package rubric.basestation;

import java.util.ArrayDeque;
import java.util.ArrayList;
import java.util.Deque;
import java.util.List;

/** The line to the sink: on or off, free or taken, and what waits for it. */
final class SerialLine {
  private static final int ROOM = 256;

  private final Deque<Action.Transmit> waiting = new ArrayDeque<>();
  private boolean on = true;
  private boolean taken = false;

  boolean isOn() {
    return on;
  }

  /** Returns whether a frame can be put now or queued. */
  boolean takes() {
    return on && waiting.size() < ROOM;
  }

  void put(Action.Transmit frame) {
    if (takes()) waiting.add(frame);
  }

  void setOn(boolean on) {
    this.on = on;
  }

  void setTaken(boolean taken) {
    this.taken = taken;
  }

  /** Returns the frames that leave now, in the order of their acceptance. */
  List<Action.Transmit> leaving() {
    final List<Action.Transmit> out = new ArrayList<>();
    while (on && !taken && !waiting.isEmpty()) out.add(waiting.remove());
    return out;
  }
}
