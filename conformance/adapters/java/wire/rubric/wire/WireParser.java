package rubric.wire;

import java.nio.ByteBuffer;

/** How a structure is read: a generated class's parse. */
@FunctionalInterface
public interface WireParser<V extends WireView> {
  /** What is left in `bytes`, as a structure; bytes behind it are its stale(). */
  V parse(ByteBuffer bytes) throws WireException;
}
