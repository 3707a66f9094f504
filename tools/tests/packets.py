"""Captures made by hand, of little-endian pcapng and IEEE 802.15.4."""

import struct


def fcs(data):
    """IEEE 802.15.4-2006, section 7.2.1.9, bit by bit."""
    crc = 0
    for byte in data:
        for bit in range(8):
            feedback = (crc ^ byte >> bit) & 1
            crc = crc >> 1 ^ (0x8408 if feedback else 0)
    return struct.pack("<H", crc)


def radio(number, dest, src, kind, payload):
    """Returns a frame of TinyOS, I-frame format, without FCS."""
    return struct.pack("<HBHHHBB", 0x8841, number & 255, 0x22, dest, src, 0x3F, kind) + payload


def udp(payload, port=17754):
    return struct.pack(">HHHH", 40000, port, 8 + len(payload), 0) + payload


def ipv4(payload):
    return struct.pack(">BBHHHBBH4s4s", 0x45, 0, 20 + len(payload), 0, 0, 64, 17, 0,
                       b"\x7f\0\0\1", b"\x7f\0\0\1") + payload


def block(kind, body):
    body += bytes(-len(body) % 4)
    size = len(body) + 12
    return struct.pack("<II", kind, size) + body + struct.pack("<I", size)


def section():
    return block(0x0A0D0D0A, struct.pack("<IHHq", 0x1A2B3C4D, 1, 0, -1))


def interface(link_type, options=b""):
    return block(1, struct.pack("<HHI", link_type, 0, 0) + options)


def packet_block(time_us, record, number=0):
    """Returns a record of the interface of that number."""
    return block(6, struct.pack("<IIIII", number, time_us >> 32, time_us & 0xFFFFFFFF, len(record),
                                len(record)) + record)
