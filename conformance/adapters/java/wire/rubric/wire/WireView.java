package rubric.wire;

import java.nio.ByteBuffer;
import java.util.Arrays;
import java.util.function.BiConsumer;

/**
 * A lens on the bytes of a structure. It exists only where parse found nothing wrong, so that its
 * getters cannot fail. The bytes are not copied: later changes to them change the view.
 */
public abstract class WireView {
  /** Index 0 is the structure's first byte; there may be stale bytes after its last. */
  protected final ByteBuffer bytes;

  protected WireView(CheckedBytes checked, int mostBytes) {
    final ByteBuffer all = checked.bytes;
    bytes = all.slice(0, Math.min(all.limit(), mostBytes)).asReadOnlyBuffer();
  }

  /** Returns how many of the bytes are the structure's. */
  public abstract int sizeBytes();

  /** The same values, to be changed and written. */
  public abstract WireWriter toWriter();

  /** Calls the visitor with name and value of each field, by the names of the spec. */
  public abstract void fields(BiConsumer<String, Object> visitor);

  /** The structure's bytes. */
  public final ByteBuffer bytes() {
    return range(0, sizeBytes());
  }

  /** Bytes that parse was given and that are not part of the structure. */
  public final ByteBuffer stale() {
    return range(sizeBytes(), bytes.limit() - sizeBytes());
  }

  protected final ByteBuffer range(int at, int sizeBytes) {
    return bytes.slice(at, sizeBytes);
  }

  protected final ByteBuffer rest(int at) {
    return bytes.slice(at, bytes.limit() - at);
  }

  /** Bytes that were checked with the whole. */
  protected static CheckedBytes part(ByteBuffer range) {
    return new CheckedBytes(range);
  }

  /** `bytes` as a structure, or null where they are none. */
  protected static WireView orNull(WireParser<?> parser, ByteBuffer bytes) {
    try {
      return parser.parse(bytes);
    } catch (WireException e) {
      return null;
    }
  }

  /** A number that is 0 where the bytes end before it. */
  protected static long peek(ByteBuffer bytes, int at, int width, boolean little) {
    if (at + width > bytes.limit()) return 0;
    if (width == 1) return Wire.u1(bytes, at);
    if (width == 2) return little ? Wire.u2le(bytes, at) : Wire.u2be(bytes, at);
    return little ? Wire.u4le(bytes, at) : Wire.u4be(bytes, at);
  }

  /** Structures of the same kind with the same bytes. */
  @Override
  public final boolean equals(Object other) {
    return other != null && other.getClass() == getClass()
        && ((WireView) other).bytes().equals(bytes());
  }

  @Override
  public final int hashCode() {
    return bytes().hashCode();
  }

  /** All fields: "NetMsg{dest=RAddr{pid=11, devid=5}, ...}". */
  @Override
  public final String toString() {
    final StringBuilder out = new StringBuilder(getClass().getSimpleName()).append('{');
    fields((name, value) -> {
      if (out.charAt(out.length() - 1) != '{') out.append(", ");
      out.append(name).append('=').append(text(value));
    });
    return out.append('}').toString();
  }

  private static String text(Object value) {
    if (value instanceof ByteBuffer) {
      final StringBuilder out = new StringBuilder("x");
      for (final byte b : Wire.copy((ByteBuffer) value)) out.append(String.format("%02x", b));
      return out.toString();
    }
    if (value instanceof int[]) return Arrays.toString((int[]) value);
    if (value instanceof long[]) return Arrays.toString((long[]) value);
    if (value instanceof float[]) return Arrays.toString((float[]) value);
    return String.valueOf(value);
  }
}
