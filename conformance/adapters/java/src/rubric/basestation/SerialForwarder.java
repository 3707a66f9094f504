package rubric.basestation;

import java.io.Closeable;
import java.io.DataInputStream;
import java.io.EOFException;
import java.io.IOException;
import java.io.OutputStream;
import java.net.InetAddress;
import java.net.InetSocketAddress;
import java.net.Socket;
import java.nio.ByteBuffer;
import rubric.wire.Wire;
import rubric.wire.WireException;
import rubric.wire.tinyos.SfPacket;

/** A connection with a TinyOS serial forwarder: packets from the dispatch byte on, both ways. */
final class SerialForwarder implements Closeable {
  private static final int CONNECT_MS = 5000;
  private static final int MAGIC = 'U';
  private static final int VERSION = ' ';

  private final Socket socket;
  private final DataInputStream in;
  private final OutputStream out;

  /** Connects and agrees on a version; IOException says what the other side did wrong. */
  SerialForwarder(String host, int port) throws IOException {
    socket = new Socket();
    try {
      // `localhost` always means loopback (RFC 6761), whatever a resolver says.
      final InetAddress to = host.equalsIgnoreCase("localhost")
          ? InetAddress.getLoopbackAddress() : InetAddress.getByName(host);
      socket.connect(new InetSocketAddress(to, port), CONNECT_MS);
      socket.setTcpNoDelay(true);
      in = new DataInputStream(socket.getInputStream());
      out = socket.getOutputStream();
      //= WIRE-SF-HANDSHAKE: A serial forwarder stream begins with the byte 0x55 and a version byte
      //= from each side.
      out.write(new byte[] {MAGIC, VERSION});
      socket.setSoTimeout(CONNECT_MS); // A silent peer is no forwarder.
      final int magic = in.readUnsignedByte();
      final int version = in.readUnsignedByte();
      // The lower version of the two is spoken; there is none below this one.
      if (magic != MAGIC || version < VERSION) {
        throw new IOException(String.format(
            "no serial forwarder of version 0x%02x or later: it began with %02x %02x", VERSION,
            magic, version));
      }
      socket.setSoTimeout(0);
    } catch (IOException e) {
      socket.close();
      throw e;
    }
  }

  /** The next packet; null at the end of the connection. */
  byte[] read() throws IOException {
    while (true) {
      final int length = in.read();
      if (length < 0) return null;
      //= WIRE-SF-LENGTH: A serial forwarder packet is a length byte of 1 to 255 and that many
      //= bytes from the dispatch byte on.
      if (length == 0) continue; // Nothing was lost but a byte; the next one begins a packet.
      final byte[] packet = in.readNBytes(length);
      if (packet.length < length) throw new EOFException("the connection ended within a packet");
      return packet;
    }
  }

  void write(byte[] packet) throws IOException {
    final ByteBuffer bytes;
    try {
      bytes = new SfPacket.Writer().packet(packet).toBytes();
    } catch (WireException e) {
      throw new IOException(e);
    }
    out.write(Wire.copy(bytes));
    out.flush();
  }

  @Override
  public void close() throws IOException {
    socket.close();
  }
}
