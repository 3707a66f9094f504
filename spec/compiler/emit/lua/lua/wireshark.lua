-- The Wireshark side: fields, expert information, and where packets come from.
--   wtap_encap USER0: a serial frame from its kind byte to its CRC, flags and escapes removed
--   wtap_encap USER1: a packet of the serial forwarder, from the dispatch byte on
--   wpan.panid: the payload of an 802.15.4 frame of the PAN that the preferences name

local rubric = Proto("rubric", "TinyOS active message, decoded by Rubric")
local from_serial = Proto("rubric_serial", "TinyOS serial frame (Rubric)")
local from_sf = Proto("rubric_sf", "Serial forwarder packet (Rubric)")
local from_radio = Proto("rubric_radio", "TinyOS radio frame (Rubric)")

local MAC_HEADER = 9                -- IEEE 802.15.4-2006, section 7.2.1: short addresses, one PAN.
local RADIO_FRAME_MAX = 125         -- aMaxPHYPacketSize without FCS.
local FCS_BYTES = 2
local SERIAL_ACK, PACKET_ACK, PACKET_NOACK = 67, 68, 69  -- TEP 113, section 3.1.
local CONTENT_MIN = 4               -- Kind, a byte, CRC.
local AFTER_HEADER_MAX = 254        -- Bytes after kind and sequence number, CRC included.
local SF_PACKET_MAX = 255           -- What a length byte can say.
local AM_BROADCAST = 0xffff         -- TEP 116.

-- Fields, by their names in filters.

local fields = {}
local field_list = {}

local function define(abbreviation, make)
  if fields[abbreviation] then return end
  fields[abbreviation] = make()
  field_list[#field_list + 1] = fields[abbreviation]
end

local NUMBERS = {
  uint = {ProtoField.uint8, ProtoField.uint16, [4] = ProtoField.uint32, [8] = ProtoField.uint64},
  sint = {ProtoField.int8, ProtoField.int16, [4] = ProtoField.int32, [8] = ProtoField.int64},
  mask = {ProtoField.uint8, ProtoField.uint16},
}

local function define_mask(field, abbreviation)
  local bits = masks[field.mask]
  define(abbreviation, function()
    return NUMBERS.mask[field.width](abbreviation, field.name, base.HEX, nil, nil, field.doc)
  end)
  for i = 1, bits.count do
    if bits[i] then
      define(abbreviation .. "." .. bits[i], function()
        return ProtoField.bool(abbreviation .. "." .. bits[i], bits[i], bits.count, nil, 2 ^ (i - 1))
      end)
    end
  end
end

local shapes = {}  -- What the field of each name holds.

-- The name of a field. Protocols may use one name for things that no field of Wireshark's can both
-- hold: the second one is told apart.
local function name_of(field, prefix)
  local abbreviation = prefix .. "." .. field.name
  local shape = field.cases and "bytes" or field.text and "text" or field.bits and "uint4" or
      field.kind .. (field.width or "")
  shapes[abbreviation] = shapes[abbreviation] or shape
  return shapes[abbreviation] == shape and abbreviation or abbreviation .. "_" .. shape
end

local define_message, define_parts

local function define_field(field, prefix)
  local abbreviation = name_of(field, prefix)
  if field.kind == "mask" then
    define_mask(field, abbreviation)
  elseif field.kind == "float" then
    define(abbreviation, function()
      return ProtoField.float(abbreviation, field.name, field.doc)
    end)
  elseif field.bits then
    define(abbreviation, function()
      return ProtoField.uint32(abbreviation, field.name, base.DEC, enums[field.enum], nil,
                               field.doc)
    end)
  elseif field.width then
    define(abbreviation, function()
      return NUMBERS[field.kind][field.width](abbreviation, field.name, base.DEC,
                                              enums[field.enum], nil, field.doc)
    end)
  elseif field.cases then
    -- Bytes without a message stay bytes.
    define(abbreviation, function()
      return ProtoField.bytes(abbreviation, field.name, base.SPACE, field.doc)
    end)
    for _, name in pairs(field.cases) do define_message(types[name]) end
    if field.otherwise then define_message(types[field.otherwise]) end
  elseif field.type then
    define(abbreviation, function()
      return ProtoField.none(abbreviation, field.name, field.doc)
    end)
    define_parts(types[field.type], abbreviation)
  elseif field.text then
    define(abbreviation, function()
      return ProtoField.string(abbreviation, field.name, base.UNICODE, field.doc)
    end)
  else
    define(abbreviation, function()
      return ProtoField.bytes(abbreviation, field.name, base.SPACE, field.doc)
    end)
  end
end

define_parts = function(type, abbreviation)
  for _, field in ipairs(type) do define_field(field, abbreviation) end
  for _, one in ipairs(type.interpretations or {}) do
    if one.cases then
      define_field(one, abbreviation)
    else
      define_message(types[one.type])
    end
  end
end

local defined = {}  -- Types; some share a name, as what PCs and motes send.

define_message = function(type)
  if defined[type] then return end
  defined[type] = true
  local abbreviation = "rubric." .. type.name
  define(abbreviation, function()
    return ProtoField.none(abbreviation, type.name, type.doc)
  end)
  define_parts(type, abbreviation)
end

local function define_protocol(protocol)
  for _, name in pairs(protocol.carriers) do
    for _, field in ipairs(types[name]) do define_field(field, "rubric") end
  end
end

local function define_all()
  define_protocol(protocols[usual_protocol])
  for _, protocol in ipairs(protocols) do define_protocol(protocol) end
  for _, field in ipairs(types[serial_frame]) do
    define_field(field, "rubric.serial")
  end
  for name, doc in pairs({
    message = "The innermost message that was found", path = "Messages from the outermost in",
    fault = "What is wrong", rule = "The requirement that is broken",
  }) do
    define("rubric." .. name, function()
      return ProtoField.string("rubric." .. name, name, base.ASCII, doc)
    end)
  end
  define("rubric.am_type", function()
    return ProtoField.uint8("rubric.am_type", "AM type", base.DEC)
  end)
  define("rubric.fault_offset", function()
    return ProtoField.uint32("rubric.fault_offset", "fault offset", base.DEC, nil, nil,
                             "Of the first wrong byte, from the dispatch byte or frame control on")
  end)
  define("rubric.stale", function()
    return ProtoField.bytes("rubric.stale", "stale", base.SPACE, "Bytes that mean nothing")
  end)
  define("rubric.cut_off", function()
    return ProtoField.bytes("rubric.cut_off", "cut off", base.SPACE,
                            "Bytes of a field that needs more of them")
  end)
  define("rubric.serial.crc", function()
    return ProtoField.uint16("rubric.serial.crc", "crc", base.HEX, nil, nil, "CRC-16, low byte first")
  end)
end
define_all()
rubric.fields = field_list

local fault_expert = ProtoExpert.new("rubric.malformed", "A rule of the wire is broken",
                                     expert.group.MALFORMED, expert.severity.ERROR)
local note_expert = ProtoExpert.new("rubric.note", "Remarkable", expert.group.UNDECODED,
                                    expert.severity.NOTE)
rubric.experts = {fault_expert, note_expert}

-- Showing what was decoded. `view` says which bytes of which tvb an offset means.

local function range_of(view, offset, size)
  return view.tvb(offset - view.skipped, size)
end

local function add_number(tree, abbreviation, field, node, view)
  local range = range_of(view, node.offset, node.size)
  local add_to = field.little and tree.add_le or tree.add
  local item = field.bits and tree:add(fields[abbreviation], range, node.value) or
      add_to(tree, fields[abbreviation], range)
  if field.enum and not enums[field.enum][node.value] then
    item:set_text(field.name .. ": " .. integer_text(field, node.value, range:raw(), 0))
  end
  if field.kind == "mask" then
    local bits = masks[field.mask]
    for i = 1, bits.count do
      if bits[i] then add_to(item, fields[abbreviation .. "." .. bits[i]], range) end
    end
  end
  if field.unit and field.kind ~= "float" then
    item:append_text(string.format(" (%g %s)", node.value * field.scale + field.zero, field.unit))
  end
end

local show

local function show_children(tree, node, prefix, view)
  for _, child in ipairs(node) do show(tree, child, prefix, view) end
end

show = function(tree, node, prefix, view)
  local field = node.field
  if node.offset < view.skipped then return end  -- Another dissector has shown it.
  local abbreviation = name_of(field, prefix)
  if node.kind == "number" then
    add_number(tree, abbreviation, field, node, view)
  elseif node.kind == "numbers" then
    show_children(tree, node, prefix, view)
  elseif node.kind == "bytes" then
    if node.size > 0 then
      -- What is left of numbers that were cut off is no number.
      local whole = field.kind == "bytes" or field.cases
      local range = range_of(view, node.offset, node.size)
      local shown = fields[whole and abbreviation or "rubric.cut_off"]
      if field.text then
        tree:add(shown, range, (text_of(field, range:raw())))
      else
        tree:add(shown, range)
      end
    end
  elseif node.kind == "structs" then
    for _, child in ipairs(node) do
      local branch = tree:add(fields[abbreviation], range_of(view, child.offset, child.size))
      show_children(branch, child, abbreviation, view)
    end
  else
    -- A chosen message begins a name of its own; other structures lengthen that of their message.
    if node.type ~= types[field.type] or field.message then
      abbreviation = "rubric." .. node.type.name
    end
    if node.size == 0 and #node == 0 then return end  -- The frame ended before it.
    local branch = tree:add(fields[abbreviation], range_of(view, node.offset, node.size))
    show_children(branch, node, abbreviation, view)
  end
end

-- What the column Info says: the fields as `rubric decode` prints them.

local HEX_MOST, ELEMENTS_MOST = 24, 24

local function hex_text(bytes)
  if #bytes == 0 then return "(empty)" end
  local text = bytes:sub(1, HEX_MOST):gsub(".", function(c)
    return string.format("%02x", c:byte())
  end)
  return #bytes > HEX_MOST and text .. "..(" .. #bytes .. " bytes)" or text
end

-- In quotes; bytes of which it does not say all follow in hex.
local function quoted_text(field, bytes)
  local text, _, all = text_of(field, bytes)
  local escapes = {['"'] = '\\"', ["\\"] = "\\\\", ["\n"] = "\\n", ["\r"] = "\\r", ["\t"] = "\\t"}
  text = '"' .. text:gsub('[%c"\\]', function(c) return escapes[c] or "\239\191\189" end) .. '"'
  return all and text or text .. " (" .. hex_text(bytes) .. ")"
end

local function mask_text(field, value)
  local names = {}
  for i = 1, masks[field.mask].count do
    if math.floor(value / 2 ^ (i - 1)) % 2 == 1 then
      names[#names + 1] = masks[field.mask][i] or "bit" .. i - 1
    end
  end
  return #names == 0 and "0" or table.concat(names, "|")
end

-- Of a number's bits, IEEE 754 binary32: the shortest text that reads back.
local function float_text(bits)
  local exponent, fraction = math.floor(bits / 2 ^ 23) % 256, bits % 2 ^ 23
  local sign = bits >= 2 ^ 31 and "-" or ""
  if exponent == 255 then return sign .. (fraction == 0 and "inf" or "nan") end
  if exponent == 0 and fraction == 0 then return sign .. "0" end
  local step = 2 ^ (math.max(exponent, 1) - 150)  -- To the next larger number.
  local value = (exponent == 0 and fraction or fraction + 2 ^ 23) * step
  local digits, short, off = 0  -- Digits after the first one.
  repeat
    short = string.format("%." .. digits .. "e", value)
    off = tonumber(short) - value
    digits = digits + 1
    local room = (off < 0 and fraction == 0 and exponent > 1) and step / 4 or step / 2
  until math.abs(off) < room or math.abs(off) == room and fraction % 2 == 0
  local power = tonumber(short:match("e(.*)"))
  if power < -4 or power >= 16 then return sign .. short end
  return sign .. string.format("%." .. math.max(0, digits - 1 - power) .. "f", tonumber(short))
end

function Decoder:number_text(node)
  local field, value = node.field, node.value
  if field.kind == "mask" then return mask_text(field, value) end
  if field.kind == "float" then return float_text(value) end
  return field.enum and enums[field.enum][value] or
      integer_text(field, value, self.bytes, node.offset)
end

local function is_pair(node)
  return #node == 2 and node[1].kind == "number" and node[2].kind == "number"
end

local function structure_text(out, node)
  if is_pair(node) then
    return out:number_text(node[1]) .. ":" .. out:number_text(node[2])
  end
  return "{" .. out:fields_text(node) .. "}"
end

function Decoder:value_text(node)
  if node.kind == "number" then return self:number_text(node) end
  if node.kind == "bytes" then
    local bytes = self.bytes:sub(node.offset + 1, node.offset + node.size)
    return node.field.text and quoted_text(node.field, bytes) or hex_text(bytes)
  end
  if node.kind == "struct" then return structure_text(self, node) end
  local parts = {}
  for i, child in ipairs(node) do
    if node.kind == "numbers" and i > ELEMENTS_MOST then
      parts[i] = ".." .. #node .. " in all"
      break
    end
    parts[i] = node.kind == "numbers" and self:number_text(child) or structure_text(self, child)
  end
  return "[" .. table.concat(parts, " ") .. "]"
end

-- Messages within the message follow after a bar.
function Decoder:fields_text(node)
  local parts = {}
  for _, child in ipairs(node) do
    local structure = child.kind == "struct"
    if structure and self:is_message(child) then
      parts[#parts + 1] = "| " .. self:fields_text(child)
    elseif not structure or #child > 0 then
      local equals = structure and not is_pair(child) and "" or "="
      parts[#parts + 1] = child.field.name .. equals .. self:value_text(child)
    end
  end
  return table.concat(parts, " ")
end

function Decoder:is_message(node)
  for _, type in ipairs(self.path) do
    if node.type == type then return true end
  end
  return false
end

-- The outermost message of a frame, or nil.
local function payload_of(out, node)
  for _, child in ipairs(node) do
    if child.kind == "struct" and out:is_message(child) then return child end
    local inner = child.kind == "struct" and payload_of(out, child)
    if inner then return inner end
  end
  return nil
end

local function path_text(path)
  local names = {}
  for i, type in ipairs(path) do names[i] = type.name end
  return table.concat(names, "/")
end

local frame_size, frame_kept = Field.new("frame.len"), Field.new("frame.cap_len")

local function show_fault(tree, pinfo, err, range)
  local size, kept = frame_size().value, frame_kept().value
  if kept < size then  -- No fault of the sender.
    local text = string.format("cut by the capture (%d of %d bytes)", kept, size)
    tree:add_tvb_expert_info(note_expert, range, text)
    pinfo.cols.info:append(" * " .. text)
    return
  end
  local rule = rules[err.rule]
  local text = err.fault .. ": " .. err.text
  if rule then text = text .. " [" .. err.rule .. " " .. rule.level .. ": " .. rule.text .. "]" end
  tree:add(fields["rubric.fault"], err.fault):set_generated()
  tree:add(fields["rubric.fault_offset"], err.offset):set_generated()
  if rule then tree:add(fields["rubric.rule"], err.rule):set_generated() end
  tree:add_tvb_expert_info(fault_expert, range, text)
  pinfo.cols.info:append(" !! " .. err.fault .. " at " .. err.offset .. ": " .. err.text)
end

local function show_all(tree, pinfo, out, view, am_type, fault)
  show_children(tree, out[1], "rubric", view)
  local path = path_text(out.path)
  if am_type then tree:add(fields["rubric.am_type"], am_type):set_generated() end
  if #out.path > 0 then
    tree:add(fields["rubric.path"], path):set_generated()
    tree:add(fields["rubric.message"], out.path[#out.path].name):set_generated()
  end
  for _, stale in ipairs(out.stale) do
    tree:add(fields["rubric.stale"], range_of(view, stale.offset, stale.size))
  end
  local message = payload_of(out, out[1])
  pinfo.cols.info = (path ~= "" and path or "AM " .. tostring(am_type or "?")) ..
      (message and " " .. out:fields_text(message) or "")
  local whole = view.tvb()
  for _, note in ipairs(out.notes) do
    tree:add_tvb_expert_info(note_expert, whole, note.kind .. " at " .. note.offset .. ": " ..
                             note.text)
  end
  local err = fault or out.error
  if err then show_fault(tree, pinfo, err, whole) end
end

-- Where packets come from.

rubric.prefs.protocol = Pref.enum("Protocol", usual_protocol, "Whose messages the frames carry",
                                  protocol_choices, false)
rubric.prefs.pan = Pref.uint("PAN (AM group)", 0x22, "Radio frames of this PAN are decoded")

local function protocol() return protocols[rubric.prefs.protocol] end

local function radio_choice(carriers)
  local type = carriers.radio_i and types[carriers.radio_i]
  local last = type and type[#type]
  return last and last.cases and last or nil
end

local function begin(pinfo, root, tvb)
  pinfo.cols.protocol = protocol().name
  return root:add(rubric, tvb())
end

local function address_text(address)
  return address == AM_BROADCAST and "Broadcast" or string.format("0x%04x", address)
end

-- Says where a packet of a serial line or a forwarder goes, as Wireshark does for radio frames.
local function show_addresses(pinfo, header)
  for _, one in ipairs(header or {}) do
    if one.field.name == "dest" then pinfo.cols.dst = address_text(one.value) end
    if one.field.name == "src" then pinfo.cols.src = address_text(one.value) end
  end
end

-- A protocol need not travel everywhere.
local function is_there(carrier, tree, tvb)
  if carrier then return true end
  tree:add_tvb_expert_info(note_expert, tvb(), "not_decoded: the protocol has no such frames")
  return false
end

local function dissect_packet(tvb, pinfo, tree, fault)
  local carriers = protocol().carriers
  if not is_there(carriers.serial, tree, tvb) then return end
  local out = decode(carriers.serial, tvb:raw(), radio_choice(carriers))
  local am_type = tvb:len() >= 8 and tvb(0, 1):uint() == 0 and tvb(7, 1):uint() or nil
  show_addresses(pinfo, out[1][1])
  show_all(tree, pinfo, out, {tvb = tvb, skipped = 0}, am_type, fault)
end

function from_sf.dissector(tvb, pinfo, root)
  local tree = begin(pinfo, root, tvb)
  if tvb:len() == 0 then
    return show_fault(tree, pinfo, {fault = "empty", offset = 0, rule = "WIRE-SF-LENGTH",
                                    text = "the packet has no bytes"}, tvb())
  end
  local fault = tvb:len() > SF_PACKET_MAX and
      {fault = "too_long", offset = SF_PACKET_MAX, rule = "WIRE-SF-LENGTH",
       text = "the packet is beyond the largest possible size"} or nil
  dissect_packet(tvb, pinfo, tree, fault)
end

local function has_seq(kind) return kind == SERIAL_ACK or kind == PACKET_ACK end

local function serial_fault(bytes, kind)
  local size = #bytes
  local max = AFTER_HEADER_MAX + (has_seq(kind) and 2 or 1)
  if size > max then
    return {fault = "too_long", offset = max, rule = "WIRE-HDLC-LONG",
            text = "the frame is beyond the largest possible size"}
  elseif size < CONTENT_MIN then
    return {fault = "too_short", offset = size, rule = "WIRE-HDLC-SHORT",
            text = "the frame is below the smallest possible size"}
  end
  local found = bytes:byte(size) * 256 + bytes:byte(size - 1)
  local right = crc16(bytes, size - 2)
  if found == right then return nil end
  return {fault = "crc", offset = size - 2, rule = "WIRE-SERIAL-CRC",
          text = string.format("the check sum is 0x%04x, the bytes give 0x%04x", found, right)}
end

function from_serial.dissector(tvb, pinfo, root)
  local tree = begin(pinfo, root, tvb)
  local size = tvb:len()
  local kind = size > 0 and tvb(0, 1):uint() or -1
  local fault = serial_fault(tvb:raw(), kind)
  if size == 0 then return show_fault(tree, pinfo, fault, tvb()) end
  tree:add(fields["rubric.serial.kind"], tvb(0, 1))
  local at, last = 1, size
  if size >= 3 then
    last = size - 2
    tree:add_le(fields["rubric.serial.crc"], tvb(last, 2))
  end
  if has_seq(kind) and at < last then
    tree:add(fields["rubric.serial.seq_num"], tvb(at, 1))
    at = at + 1
  end
  -- Faults count from the dispatch byte, as everywhere in Rubric.
  if fault then fault.offset = math.max(0, fault.offset - at) end
  local is_packet = kind == PACKET_ACK or kind == PACKET_NOACK
  if is_packet and at < last then
    return dissect_packet(tvb(at, last - at):tvb(), pinfo, tree, fault)
  end
  pinfo.cols.info = enums[types[serial_frame][1].enum][kind] or "serial frame of kind " .. kind
  if fault then show_fault(tree, pinfo, fault, tvb()) end
end

local frame_control = Field.new("wpan.fcf")
local encapsulation = Field.new("frame.encap_type")
local mac_fields = {{frame_control, 2}, {Field.new("wpan.seq_no"), 1},
                    {Field.new("wpan.dst_pan"), 2}, {Field.new("wpan.dst16"), 2},
                    {Field.new("wpan.src16"), 2}}

-- The 802.15.4 dissector has taken the header off; the tables count from its first byte.
local function mac_header()
  local bytes = {}
  for _, one in ipairs(mac_fields) do
    local found = one[1]()
    local value = found and found.value or 0
    for _ = 1, one[2] do
      bytes[#bytes + 1] = string.char(value % 256)
      value = math.floor(value / 256)
    end
  end
  return table.concat(bytes)
end

function from_radio.dissector(tvb, pinfo, root)
  local tree = begin(pinfo, root, tvb)
  local control = frame_control()
  -- Data frame, short addresses, PAN id compression; what says more or less carries no AM message.
  local shape = control and control.value or 0
  local plain = shape % 16 % 8 == 1 and math.floor(shape / 64) % 2 == 1 and
      math.floor(shape / 1024) % 4 == 2 and math.floor(shape / 16384) % 4 == 2
  if not plain then
    tree:add_tvb_expert_info(note_expert, tvb(), "not_decoded: another kind of 802.15.4 frame")
    return
  end
  local carriers = protocol().carriers
  local bytes = tvb:raw()
  local is_i_frame = #bytes == 0 or bytes:byte(1) == 0x3f
  local name = is_i_frame and carriers.radio_i or carriers.radio_t
  if not is_there(name, tree, tvb) then return end
  local out = decode(name, mac_header() .. bytes)
  local am_type = bytes:byte(is_i_frame and 2 or 1)
  local fault
  if MAC_HEADER + #bytes > RADIO_FRAME_MAX then
    local with_fcs = encapsulation().value == wtap.IEEE802_15_4
    fault = {fault = "too_long", rule = "WIRE-RADIO-LENGTH",
             offset = RADIO_FRAME_MAX + (with_fcs and FCS_BYTES or 0),
             text = "the frame is beyond the largest possible size"}
  end
  show_all(tree, pinfo, out, {tvb = tvb, skipped = MAC_HEADER}, am_type, fault)
end

local encapsulations = DissectorTable.get("wtap_encap")
encapsulations:add(wtap.USER0, from_serial)
encapsulations:add(wtap.USER1, from_sf)

local pans = DissectorTable.get("wpan.panid")
local registered_pan

local function register_pan()
  if registered_pan then pans:remove(registered_pan, from_radio) end
  registered_pan = rubric.prefs.pan
  pans:add(registered_pan, from_radio)
end
register_pan()
rubric.prefs_changed = register_pan
