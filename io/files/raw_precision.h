// Numbers without any format around them.
#pragma once

namespace raycone {

enum class RawPrecision { kDouble, kSingle };  // IEEE 754, 64 or 32 bits, little-endian

}  // namespace raycone
