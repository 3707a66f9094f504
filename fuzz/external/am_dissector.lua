-- TinyOS serial frames with RUBICON messages, for Wireshark: what somebody might write by hand from
-- TEP 113 and the tables of a protocol. Frames come from kind byte to CRC, as link type USER0.
-- tshark -X lua_script:am_dissector.lua -r frames.pcapng

local am = Proto("tinyos_am", "TinyOS serial active message")

local KIND_ACK, KIND_PACKET_ACK, KIND_PACKET_NOACK = 0x43, 0x44, 0x45
local SHORTEST, LONGEST, HEADER, CRC = 4, 254, 8, 2
local AM_NET = 28

local f = {
  kind = ProtoField.uint8("tinyos_am.kind", "Kind", base.HEX),
  seq = ProtoField.uint8("tinyos_am.serial_seq", "Sequence number"),
  dest = ProtoField.uint16("tinyos_am.dest", "Destination", base.DEC),
  src = ProtoField.uint16("tinyos_am.src", "Source", base.DEC),
  length = ProtoField.uint8("tinyos_am.length", "Length"),
  group = ProtoField.uint8("tinyos_am.group", "Group"),
  type = ProtoField.uint8("tinyos_am.type", "Type"),
  reliable = ProtoField.uint8("tinyos_am.net.reliable", "Reliable"),
  net_seq = ProtoField.uint16("tinyos_am.net.seq_num", "Network sequence number", base.DEC),
  nbytes = ProtoField.uint8("tinyos_am.net.nbytes", "Bytes of the payload"),
  code = ProtoField.uint8("tinyos_am.code", "Code"),
  value = ProtoField.uint16("tinyos_am.config.value", "Value", base.DEC),
  malformed = ProtoField.string("tinyos_am.malformed", "Malformed"),
}
for _, field in pairs(f) do table.insert(am.fields, field) end

-- Messages of a fixed size, by AM type.
local FIXED = {[11] = 5, [12] = 13, [37] = 3}
-- Messages with a count: where it stands, behind how many bytes the elements begin, how many bytes
-- each has, and how many there may be.
local COUNTED = {
  [20] = {at = 7, from = 8, each = 1, most = 92},
  [21] = {at = 7, from = 8, each = 4, most = 23},
}

-- CRC-16, polynomial 0x1021, initial value 0.
local function crc16(buffer, size)
  local crc = 0
  for i = 0, size - 1 do
    crc = bit.bxor(crc, bit.lshift(buffer(i, 1):uint(), 8))
    for _ = 1, 8 do
      local carry = bit.band(crc, 0x8000) ~= 0
      crc = bit.band(bit.lshift(crc, 1), 0xffff)
      if carry then crc = bit.bxor(crc, 0x1021) end
    end
  end
  return crc
end

-- What is wrong with a network message, or nil.
local function net(payload, tree)
  if payload:len() < 12 then return "network header cut off" end
  local reliable, nbytes = payload(8, 1):uint(), payload(11, 1):uint()
  tree:add(f.reliable, payload(8, 1))
  tree:add(f.net_seq, payload(9, 2))
  tree:add(f.nbytes, payload(11, 1))
  if reliable > 1 then return "reliable is " .. reliable end
  if nbytes < 2 or nbytes > 102 then return "nbytes is " .. nbytes end
  if payload:len() - 12 < nbytes then return "payload cut off" end
end

-- What is wrong with the message, or nil. Bytes behind it are left over from other messages.
local function message(am_type, payload, tree)
  if am_type == AM_NET then return net(payload, tree) end
  local least = FIXED[am_type]
  local counted = COUNTED[am_type]
  if counted then
    if payload:len() < counted.from then return "message cut off" end
    local count = payload(counted.at, 1):uint()
    if count > counted.most then return "count is " .. count end
    least = counted.from + count * counted.each
  end
  if least and payload:len() < least then return "message cut off" end
  if am_type == 37 then
    tree:add(f.code, payload(0, 1))
    tree:add(f.value, payload(1, 2))
  end
end

-- What is wrong with the active message, or nil.
local function active_message(packet, tree)
  if packet:len() >= 1 and packet(0, 1):uint() ~= 0 then return "dispatch byte is not 0" end
  if packet:len() < HEADER then return "header cut off" end
  tree:add(f.dest, packet(1, 2))
  tree:add(f.src, packet(3, 2))
  tree:add(f.length, packet(5, 1))
  tree:add(f.group, packet(6, 1))
  tree:add(f.type, packet(7, 1))
  local length = packet(5, 1):uint()
  if length > 114 then return "length is " .. length end
  if packet:len() - HEADER ~= length then return "length does not match" end
  if length == 0 then return message(packet(7, 1):uint(), ByteArray.new():tvb(), tree) end
  return message(packet(7, 1):uint(), packet(HEADER, length), tree)
end

local function frame(buffer, tree)
  local size = buffer:len()
  if size < SHORTEST then return "frame too short" end
  local kind = buffer(0, 1):uint()
  tree:add(f.kind, buffer(0, 1))
  local from = 1
  if kind == KIND_ACK or kind == KIND_PACKET_ACK then
    tree:add(f.seq, buffer(1, 1))
    from = 2
  end
  if size - from > LONGEST then return "frame too long" end
  if crc16(buffer, size - CRC) ~= buffer(size - CRC, CRC):le_uint() then return "wrong CRC" end
  if kind ~= KIND_PACKET_ACK and kind ~= KIND_PACKET_NOACK then return nil end
  if size - CRC == from then return "empty packet" end
  return active_message(buffer(from, size - CRC - from), tree)
end

function am.dissector(buffer, pinfo, tree)
  pinfo.cols.protocol = "TinyOS AM"
  local subtree = tree:add(am, buffer())
  local problem = frame(buffer, subtree)
  if problem then subtree:add(f.malformed, problem) end
end

DissectorTable.get("wtap_encap"):add(wtap.USER0, am)
