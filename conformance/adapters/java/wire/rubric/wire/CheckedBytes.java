package rubric.wire;

import java.nio.ByteBuffer;

/** Bytes in which a reader found nothing wrong; only readers and views make them. */
public final class CheckedBytes {
  final ByteBuffer bytes;

  CheckedBytes(ByteBuffer bytes) {
    this.bytes = bytes;
  }
}
