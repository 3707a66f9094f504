-- Decoding by the tables above: the same rules as codec/reflect/decode.cc, in Lua. It knows the
-- tables' form and no protocol.

-- What expressions read: numbers at an offset from the start of a structure, 0 beyond its end, and
-- what its parameters are. `node`: the structure, as far as it is decoded.
local Window = {}
Window.__index = Window

local function window(bytes, base, limit, params, node)
  return setmetatable({bytes = bytes, base = base, limit = limit, params = params, node = node},
                      Window)
end

-- The same from the start of a field, which lies where those before it end.
function Window:from(index)
  for _, child in ipairs(self.node) do
    if child.field == self.node.type[index] then
      return window(self.bytes, child.offset, self.limit)
    end
  end
  return window(self.bytes, self.limit, self.limit)
end

-- Both round down, as Kaitai Struct does; by 0 they are 0.
function Window:quotient(a, b) return b == 0 and 0 or math.floor(a / b) end
function Window:remainder(a, b) return b == 0 and 0 or a % b end

-- The bits that are set in so many of both numbers.
local function joined(a, b, once, twice)
  local value, place = 0, 1
  while a > 0 or b > 0 do
    local set = a % 2 + b % 2
    if set == 1 and once or set == 2 and twice then value = value + place end
    a, b, place = math.floor(a / 2), math.floor(b / 2), place * 2
  end
  return value
end
function Window:bit_and(a, b) return joined(a, b, false, true) end
function Window:bit_or(a, b) return joined(a, b, true, true) end
function Window:bit_xor(a, b) return joined(a, b, true, false) end
function Window:left(a, b) return math.floor(a * 2 ^ b) end
function Window:right(a, b) return math.floor(a / 2 ^ b) end
function Window:select(condition, a, b)
  if condition then return a end
  return b
end

function Window:u8(offset)
  local at = self.base + offset
  if at + 1 > self.limit then return 0 end
  return self.bytes:byte(at + 1)
end

local function number_at(bytes, at, width, little)
  local value = width == 8 and 0.0 or 0  -- Where integers have 64 bits, no sum of them would do.
  for i = 1, width do
    local byte = bytes:byte(at + (little and width + 1 - i or i))
    value = value * 256 + byte
  end
  return value
end

local function bits_of(number, shift, bits)
  return math.floor(math.floor(number / 2 ^ shift) % 2 ^ bits)
end

function Window:bits(offset, width, little, shift, bits)
  local at = self.base + offset
  if at + width > self.limit then return 0 end
  return bits_of(number_at(self.bytes, at, width, little), shift, bits)
end

local function loader(width, little)
  return function(self, offset)
    local at = self.base + offset
    if at + width > self.limit then return 0 end
    return number_at(self.bytes, at, width, little)
  end
end
Window.be16 = loader(2, false)
Window.le16 = loader(2, true)
Window.be32 = loader(4, false)
Window.le32 = loader(4, true)

local function load_number(field, bytes, at)
  local value = number_at(bytes, at, field.width, field.little)
  if field.bits then return bits_of(value, field.shift, field.bits) end
  if field.kind == "sint" and value >= 2 ^ (8 * field.width - 1) then
    value = value - 2 ^ (8 * field.width)
  end
  return value
end

-- An integer of a field in digits. Those of 8 bytes are rounded where they are kept as values.
local function integer_text(field, value, bytes, at)
  if field.width ~= 8 then return string.format("%d", value) end
  local low, high = field.little and at or at + 4, field.little and at + 4 or at
  local number = field.kind == "sint" and Int64 or UInt64
  return tostring(number.new(number_at(bytes, low, 4, field.little),
                             number_at(bytes, high, 4, field.little)))
end

-- One decoding. Nodes are tables: field, type, kind, offset, size, value; children from 1 on.
local Decoder = {}
Decoder.__index = Decoder

function Decoder:fail(fault, offset, field, text)
  self.error = {fault = fault, offset = offset, rule = field.rule, text = text}
  return false
end

-- The window of the open structure, which begins at `base`.
function Decoder:window(base, limit)
  return window(self.bytes, base, limit, self.params, self.open)
end

function Decoder:note(kind, offset, text)
  self.notes[#self.notes + 1] = {kind = kind, offset = offset, text = text}
end

function Decoder:add_stale(from, to)
  self.stale[#self.stale + 1] = {offset = from, size = to - from}
end

local function add(parent, kind, field, offset, size)
  local node = {kind = kind, field = field, offset = offset, size = size}
  parent[#parent + 1] = node
  return node
end

local function allowed_text(field)
  if field.min then
    return ", allowed are " .. (field.allowed or field.min .. " to " .. field.max)
  end
  local values = {}
  for i, value in ipairs(field.one_of) do values[i] = string.format("%d", value) end
  return (#values == 1 and ", must be " or ", must be one of ") .. table.concat(values, ", ")
end

function Decoder:is_allowed(field, value, at)
  if field.min then
    if value >= field.min and value <= field.max then return true end
  else
    for _, one in ipairs(field.one_of) do
      if one == value then return true end
    end
  end
  local text = field.name .. " is " .. integer_text(field, value, self.bytes, at) ..
      allowed_text(field)
  return self:fail(field.min and "out_of_range" or "unexpected", at, field, text)
end

-- The length of the character that begins there; nil if none does (RFC 3629, section 4).
local function character_at(text, at, encoding)
  local lead, second = text:byte(at, at + 1)
  if lead < 0x80 then return 1 end
  if encoding == "ASCII" or lead < 0xc2 or lead > 0xf4 or not second then return nil end
  local length = lead < 0xe0 and 2 or lead < 0xf0 and 3 or 4
  local low = lead == 0xe0 and 0xa0 or lead == 0xf0 and 0x90 or 0x80
  local high = lead == 0xed and 0x9f or lead == 0xf4 and 0x8f or 0xbf
  local rest = text:sub(at + 2, at + length - 1)
  local sound = second >= low and second <= high and #rest == length - 2 and
      not rest:find("[^\128-\191]")
  return sound and length or nil
end

-- The text of such a field, with U+FFFD for bytes that are none; where the first of these is; and
-- whether it says all, so that only its end and its padding follow.
local function text_of(field, bytes)
  local size = #bytes
  while size > 0 and bytes:byte(size) == field.padding do size = size - 1 end
  local stop = field.terminator and bytes:find(string.char(field.terminator), 1, true)
  local text = bytes:sub(1, math.min(size, stop and stop - 1 or size))
  local parts, at, wrong = {}, 1, nil
  while at <= #text do
    local length = character_at(text, at, field.text)
    wrong = wrong or not length and at - 1 or nil
    parts[#parts + 1] = length and text:sub(at, at + length - 1) or "\239\191\189"
    at = at + (length or 1)
  end
  local ends = field.terminator and (field.ends_with or #text < #bytes)
  local last = ends and string.char(field.terminator) or ""
  local fill = (field.terminator or field.padding) and string.char(field.padding or 0) or ""
  local again = text .. last .. fill:rep(#bytes - #text - #last)
  return table.concat(parts), wrong, not wrong and again == bytes
end

-- The functions below return whether all is well and where the next field begins.

local function bytes_text(count)
  return string.format("%d byte%s", count, count == 1 and "" or "s")
end

function Decoder:missing(field, at, limit, needed)
  local text = string.format("%s needs %s, the bytes end at %d", field.name, bytes_text(needed),
                             limit)
  return self:fail("truncated", limit, field, text), at
end

function Decoder:truncated(parent, field, at, limit, needed)
  if at < limit then add(parent, "bytes", field, at, limit - at) end
  return self:missing(field, at, limit, needed)
end

function Decoder:number(parent, field, at, limit)
  local width = field.width
  if field.shares then at = at - 1 end  -- Its first bits are in the last byte of the field before.
  if limit - at < width then return self:missing(field, at, limit, width) end
  local value = load_number(field, self.bytes, at)
  if (field.min or field.one_of) and not self:is_allowed(field, value, at) then
    return false, at
  end
  add(parent, "number", field, at, width).value = value
  if field.expect and value ~= field.expect then
    self:note("unexpected_value", at,
              string.format("%s is %s, expected is %d", field.name,
                            integer_text(field, value, self.bytes, at), field.expect))
  end
  return true, at + width
end

function Decoder:array(parent, field, base, at, limit)
  local element = field.kind == "struct" and types[field.type] or nil
  if field.ends then return self:up_to(parent, field, element, base, at, limit) end
  if element and element.min then
    return self:varying(parent, field, element, base, at, limit)
  end
  local width = element and element.max or field.width
  local count
  if field.count then
    count = field.count(self:window(base, limit))
    if count < 0 or count * width > limit - at then
      return self:truncated(parent, field, at, limit, count * width)
    end
  else
    count = math.floor((limit - at) / width)
    if count * width ~= limit - at then
      return self:truncated(parent, field, at, limit, (count + 1) * width)
    end
  end
  local node = add(parent, element and "structs" or "numbers", field, at, count * width)
  for i = 0, count - 1 do
    local from = at + i * width
    if element then
      if not self:call(node, element, field.arguments, field, base, limit, from, from + width) then
        return false, at
      end
    else
      add(node, "number", field, from, width).value = load_number(field, self.bytes, from)
    end
  end
  return true, at + count * width
end

local MOST_EMPTY = 256  -- Elements of a list that take no byte.

-- Elements of varying size, one after the other.
function Decoder:varying(parent, field, element, base, at, limit)
  local count = field.count and field.count(self:window(base, limit)) or limit - at
  local to_end = not field.count
  if count < 0 or not to_end and count * element.min > limit - at then
    return self:truncated(parent, field, at, limit, count * element.min)
  end
  local node = add(parent, "structs", field, at, 0)
  local good, begin = true, at
  while good and #node < count and not (to_end and at == limit) do
    local before = at
    good, at = self:call(node, element, field.arguments, field, base, limit, at, limit)
    if at == before and (to_end or #node > MOST_EMPTY) then break end
  end
  node.size = at - begin
  return good, at
end

-- Elements up to the first for which the condition holds.
function Decoder:up_to(parent, field, element, base, at, limit)
  local node = add(parent, element and "structs" or "numbers", field, at, 0)
  local good, done, begin = true, false, at
  while good and not done do
    local before = at
    if element then
      good, at = self:call(node, element, field.arguments, field, base, limit, at, limit)
    elseif limit - at < field.width then
      good = self:missing(field, at, limit, field.width)
    else
      add(node, "number", field, at, field.width).value = load_number(field, self.bytes, at)
      at = at + field.width
    end
    done = good and field.ends(window(self.bytes, before, at, self.params, node[#node]))
    if good and not done and at == before then good = self:missing(field, at, at, 1) end
  end
  node.size = at - begin
  return good, at
end

-- A message that only another carrier has, where this one has none for the key.
function Decoder:elsewhere(parent, field, key, at, limit)
  local name = self.more and self.more.cases[key]
  if not name then return false end
  if self:fits(parent, field, types[name], nil, at, at, limit) then
    self:note("radio_only", at, types[name].name .. " travels on the radio only")
  else
    self:note("does_not_fit", at, "the bytes do not fit " .. types[name].name)
    add(parent, "bytes", field, at, limit - at)
  end
  return true
end

-- What a switch chooses, and what the parameters of that are.
function Decoder:chosen(field, key)
  local name, by_key = field.cases[key], field.case_arguments or {}
  return types[name or field.otherwise], name and by_key[key] or by_key.otherwise
end

-- A structure in [at, stop) within the open one, which says what its parameters are.
function Decoder:call(parent, type, arguments, field, base, limit, at, stop)
  local outer = self.params
  if arguments then
    local params, given = {}, self:window(base, limit)
    for i, one in ipairs(arguments) do
      local value = one.value(given)
      params[i] = value
      if one.min and (value < one.min or value > one.max) then
        add(parent, "struct", field, at, 0).type = type
        return self:missing(field, at, stop, value)
      end
    end
    self.params = params
  end
  local good, used = self:structure(parent, type, field, at, stop)
  self.params = outer
  return good, used
end

function Decoder:nested(parent, field, base, at, limit, outer)
  local type, arguments = types[field.type], field.arguments
  if field.cases then
    local key = field.key(self:window(base, outer))
    type, arguments = self:chosen(field, key)
    if not type and not (field.size or field.to_end) then
      if limit > at then
        self:note("unknown_message", at, string.format("no message has the key %d", key))
      end
      return true, at
    end
    if not type then
      if base == 0 and self:elsewhere(parent, field, key, at, limit) then return true, limit end
      if limit > at then
        self:note("unknown_message", at, string.format("no message has the key %d", key))
      end
      add(parent, "bytes", field, at, limit - at)
      return true, limit
    end
    self.path[#self.path + 1] = type
  end
  local good, used = self:call(parent, type, arguments, field, base, outer, at, limit)
  if not good then return false, at end
  if not (field.size or field.to_end) then return true, used end
  if used < limit then self:add_stale(used, limit) end
  return true, limit
end

function Decoder:other(parent, field, base, at, limit)
  local last = limit
  if field.size then
    local size = field.size(self:window(base, limit))
    if size < 0 or size > limit - at then
      return self:truncated(parent, field, at, limit, size)
    end
    last = at + size
  end
  if field.ends_with then
    local unit = #field.ends_with
    local stop = at
    while stop + unit <= limit and self.bytes:sub(stop + 1, stop + unit) ~= field.ends_with do
      stop = stop + unit
    end
    if stop + unit <= limit then
      last = stop + unit
    elseif not field.may_lack_its_end then
      return self:truncated(parent, field, at, limit, limit - at + unit)
    end
  end
  if field.repeated then return self:array(parent, field, base, at, last) end
  if field.kind == "bytes" then
    add(parent, "bytes", field, at, last - at)
    if field.text then
      local bytes = self.bytes:sub(at + 1, last)
      local wrong = select(2, text_of(field, bytes))
      if wrong then
        self:note("not_text", at + wrong, string.format("%s is not %s, it has the byte %d",
                                                        field.name, field.text,
                                                        bytes:byte(wrong + 1)))
      end
    end
    return true, last
  end
  return self:nested(parent, field, base, at, last, limit)
end

-- Whether the bytes are such a structure; if not, nothing of the attempt is left.
function Decoder:fits(parent, field, type, arguments, base, at, limit)
  local nodes, notes, stale, path = #parent, #self.notes, #self.stale, #self.path
  self.path[path + 1] = type
  local good, used = self:call(parent, type, arguments, field, base, limit, at, limit)
  if good then
    if used < limit then self:add_stale(used, limit) end
    return true
  end
  self.error = nil
  local function cut(list, size)
    for i = #list, size + 1, -1 do list[i] = nil end
  end
  cut(parent, nodes)
  cut(self.notes, notes)
  cut(self.stale, stale)
  cut(self.path, path)
  return false
end

-- Tries the interpretations of the bytes of field number `index`; true if one fits.
function Decoder:interpret(parent, type, index, base, at, limit)
  local unfit, about
  local whole = self:window(base, limit)
  for _, candidate in ipairs(type.interpretations) do
    if candidate.overlays == index and (not candidate.condition or candidate.condition(whole)) then
      about = candidate
      local chosen, arguments = types[candidate.type], candidate.arguments
      if candidate.cases then
        chosen = nil
        if at < limit then chosen, arguments = self:chosen(candidate, candidate.key(whole)) end
      end
      if chosen then
        if self:fits(parent, candidate, chosen, arguments, base, at, limit) then return true end
        unfit = chosen
      end
    end
  end
  if at == limit then return false end
  local name = (about or type[index]).name
  local key = self.bytes:byte(at + 1)
  if unfit then
    self:note("does_not_fit", at,
              string.format("%s has the key %d and does not fit %s", name, key, unfit.name))
  else
    self:note("unknown_message", at, string.format("%s: no message has the key %d", name, key))
  end
  return false
end

function Decoder:structure(parent, type, field, base, limit)
  local node = add(parent, "struct", field, base, 0)
  node.type = type
  local around = self.open
  self.open = node
  if type.max and limit - base > type.max then limit = base + type.max end
  local at = base
  local good = true
  for index, one in ipairs(type) do
    if not one.condition or one.condition(self:window(base, limit)) then
      if one.width and not one.repeated then
        good, at = self:number(node, one, at, limit)
      elseif type.interpretations and one.kind == "bytes" and
          self:interpret(node, type, index, base, at, limit) then
        at = limit
      else
        good, at = self:other(node, one, base, at, limit)
      end
      if not good then break end
    end
  end
  node.size = at - base
  self.open = around
  return good, at
end

-- Decodes `bytes`, a string, as the type of that name. `more`: the field of another carrier that
-- chooses messages, or nil. Bytes left at the end are a fault.
local function decode(name, bytes, more)
  local out = setmetatable({bytes = bytes, more = more, notes = {}, stale = {}, path = {}}, Decoder)
  local type = types[name]
  local good, used = out:structure(out, type, nil, 0, #bytes)
  if good and used < #bytes then
    local rule = #type > 0 and type[#type].rule or type.rule
    out.error = {fault = "trailing", offset = used, rule = rule,
                 text = bytes_text(#bytes - used) .. " more than the length says"}
  end
  return out
end
