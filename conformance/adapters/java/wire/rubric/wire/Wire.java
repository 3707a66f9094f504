package rubric.wire;

import java.nio.ByteBuffer;

/** Numbers in bytes, whatever the byte order of the buffer; and values that must fit a width. */
public final class Wire {
  private Wire() {}

  public static int u1(ByteBuffer bytes, int at) {
    return bytes.get(at) & 0xff;
  }

  public static int u2be(ByteBuffer bytes, int at) {
    return u1(bytes, at) << 8 | u1(bytes, at + 1);
  }

  public static int u2le(ByteBuffer bytes, int at) {
    return u1(bytes, at + 1) << 8 | u1(bytes, at);
  }

  public static long u4be(ByteBuffer bytes, int at) {
    return (long) u2be(bytes, at) << 16 | u2be(bytes, at + 2);
  }

  public static long u4le(ByteBuffer bytes, int at) {
    return (long) u2le(bytes, at + 2) << 16 | u2le(bytes, at);
  }

  public static int s1(ByteBuffer bytes, int at) {
    return bytes.get(at);
  }

  public static int s2be(ByteBuffer bytes, int at) {
    return (short) u2be(bytes, at);
  }

  public static int s2le(ByteBuffer bytes, int at) {
    return (short) u2le(bytes, at);
  }

  public static int s4be(ByteBuffer bytes, int at) {
    return (int) u4be(bytes, at);
  }

  public static int s4le(ByteBuffer bytes, int at) {
    return (int) u4le(bytes, at);
  }

  public static float f4be(ByteBuffer bytes, int at) {
    return Float.intBitsToFloat(s4be(bytes, at));
  }

  public static float f4le(ByteBuffer bytes, int at) {
    return Float.intBitsToFloat(s4le(bytes, at));
  }

  /** `value`, which must be from min to max: a caller's mistake where it is not. */
  public static int fit(int value, int min, int max) {
    return (int) fit((long) value, min, max);
  }

  /** The same of wider numbers. */
  public static long fit(long value, long min, long max) {
    if (value < min || value > max) {
      throw new IllegalArgumentException(value + " is not from " + min + " to " + max);
    }
    return value;
  }

  /** A copy of `values`, each of which must be from min to max. */
  public static int[] fit(int[] values, int min, int max) {
    for (final int value : values) fit(value, min, max);
    return values.clone();
  }

  /** The same of wider numbers. */
  public static long[] fit(long[] values, long min, long max) {
    for (final long value : values) fit(value, min, max);
    return values.clone();
  }

  /** Checks that an array that is always whole has `count` elements. */
  public static void whole(int length, int count) {
    if (length != count) {
      throw new IllegalArgumentException(length + " elements, not " + count);
    }
  }

  /** A copy of what is left in `bytes`, whose position stays. */
  public static byte[] copy(ByteBuffer bytes) {
    final byte[] out = new byte[bytes.remaining()];
    bytes.duplicate().get(out);
    return out;
  }
}
