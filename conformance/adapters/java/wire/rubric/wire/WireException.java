package rubric.wire;

/** Bytes that break a rule of the wire: which rule, and where. */
public final class WireException extends Exception {
  private static final long serialVersionUID = 1;

  /** The fault of the bytes. */
  public enum Fault {
    /** They end before the field does; the offset is where they end. */
    TRUNCATED,
    /** A number is below its minimum or above its maximum. */
    OUT_OF_RANGE,
    /** A number is not one of the values that it must have. */
    UNEXPECTED
  }

  private final Fault fault;
  private final int offsetBytes;
  private final String requirement;

  public WireException(Fault fault, int offsetBytes, String requirement) {
    super(fault.name().toLowerCase(java.util.Locale.ROOT) + " at byte " + offsetBytes + ": "
        + requirement);
    this.fault = fault;
    this.offsetBytes = offsetBytes;
    this.requirement = requirement;
  }

  public Fault fault() {
    return fault;
  }

  /** Offset of the first byte that breaks the rule, from the start of the bytes. */
  public int offsetBytes() {
    return offsetBytes;
  }

  /** The rule's id, as in spec/requirements.yaml. */
  public String requirement() {
    return requirement;
  }
}
