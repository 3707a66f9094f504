"""Values as rct/1 writes them: numbers, bytes as x0a0b, addresses 11:5, channels 2->1."""

from typing import NamedTuple


class Address(NamedTuple):
    island: int
    device: int

    def __str__(self):
        return f"{self.island}:{self.device}"


class ChannelId(NamedTuple):
    source: int
    destination: int

    def __str__(self):
        return f"{self.source}->{self.destination}"


def value_of(text):
    if text.startswith("x"):
        return bytes.fromhex(text[1:])
    for mark, kind in (("->", ChannelId), (":", Address)):
        if mark in text:
            return kind(*map(int, text.split(mark)))
    return int(text) if text.isdigit() else float(text)


def text_of(value):
    if isinstance(value, bytes):
        return "x" + value.hex()
    return str(int(value) if isinstance(value, bool) else value)


def call_of(words):
    """The name, and the arguments by their names, of: join(type=2 transducers=7 actuators=1)"""
    name, _, arguments = " ".join(words).rstrip(")").partition("(")
    named = (argument.split("=") for argument in arguments.split())
    return name, {key: value_of(value) for key, value in named}
