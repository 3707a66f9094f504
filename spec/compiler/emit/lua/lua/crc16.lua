-- CRC-16 with polynomial 0x1021 from 0, high bit first, without bit operators, which Lua 5.2 and
-- 5.4 write differently.
local xor_nibbles = {}
for a = 0, 15 do
  xor_nibbles[a] = {}
  for b = 0, 15 do
    local value = 0
    for bit = 0, 3 do
      if math.floor(a / 2 ^ bit) % 2 ~= math.floor(b / 2 ^ bit) % 2 then value = value + 2 ^ bit end
    end
    xor_nibbles[a][b] = value
  end
end
local function xor8(a, b)
  return 16 * xor_nibbles[math.floor(a / 16)][math.floor(b / 16)] + xor_nibbles[a % 16][b % 16]
end

local crc_high, crc_low = {}, {}
for i = 0, 255 do
  local high, low = i, 0
  for _ = 1, 8 do
    local carry = high >= 128
    high = high * 2 % 256 + (low >= 128 and 1 or 0)
    low = low * 2 % 256
    if carry then high, low = xor8(high, 0x10), xor8(low, 0x21) end
  end
  crc_high[i], crc_low[i] = high, low
end

local function crc16(bytes, size)
  local high, low = 0, 0
  for i = 1, size do
    local index = xor8(high, bytes:byte(i))
    high, low = xor8(low, crc_high[index]), crc_low[index]
  end
  return high * 256 + low
end
