package rubric.basestation;

import java.util.HexFormat;

/** Bytes as hex digits without blanks. */
final class Hex {
  private Hex() {}

  static String of(byte[] bytes) {
    return HexFormat.of().formatHex(bytes);
  }

  /** Throws IllegalArgumentException if the text is something else. */
  static byte[] parse(String text) {
    return HexFormat.of().parseHex(text);
  }
}
