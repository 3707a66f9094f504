package rubric.basestation;

import java.util.Locale;

/** A line between nodes, in the order of their numbers in calls. A base station has no radio. */
public enum Link {
  RADIO,
  SERIAL,
  PEIS;

  @Override
  public String toString() {
    return name().toLowerCase(Locale.ROOT);
  }
}
