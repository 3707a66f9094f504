package rubric.basestation;

import java.util.function.IntPredicate;

/** The sequence numbers of a node: they count. (decision 117) */
final class SequenceNumbers {
  /** Returned by a refused send. */
  static final int NONE = 0xffff;

  private int next;

  SequenceNumbers(int first) {
    next = first & 0xffff;
  }

  /** A number that is not awaited. There must be one. */
  int take(IntPredicate isAwaited) {
    while (true) {
      final int seqNum = next;
      next = (next + 1) & 0xffff;
      //= N12-ERROR: 0xFFFF, the error value of send, is not used as a sequence number.
      if (seqNum == NONE) continue;
      //= N12-REUSE: A sequence number is not used again while its ack is awaited.
      if (isAwaited.test(seqNum)) continue;
      return seqNum;
    }
  }
}
