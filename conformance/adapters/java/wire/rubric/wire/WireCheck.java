package rubric.wire;

/** The rules of a structure. */
@FunctionalInterface
public interface WireCheck {
  /** Takes the structure from `in`. */
  void check(WireReader in) throws WireException;
}
