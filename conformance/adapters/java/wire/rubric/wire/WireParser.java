package rubric.wire;

import java.nio.ByteBuffer;

/** Reads a structure: a generated class's parse. */
@FunctionalInterface
public interface WireParser<V extends WireView> {
  /** Returns the rest of `bytes` as a structure; bytes after it are its stale(). */
  V parse(ByteBuffer bytes) throws WireException;
}
