// Where the head of a NIfTI-1 file has its fields, by their names in nifti1.h (nifti.nimh.nih.gov).
#pragma once

#include <cstddef>

namespace raycone::nifti {

inline constexpr std::size_t kHeadSize = 348;  // bytes, which is also what its first number says

// In bytes from the start of the file.
inline constexpr std::size_t kSizeOfHead = 0, kDim = 40, kDataType = 70, kBitPix = 72, kPixDim = 76, kVoxOffset = 108,
                             kSclSlope = 112, kDescrip = 148, kQFormCode = 252, kSFormCode = 254, kQuatern = 256,
                             kQOffset = 268, kSRow = 280, kMagic = 344;

inline constexpr std::size_t kDescripRoom = 80;  // bytes
inline constexpr std::size_t kRowSize = 16;      // bytes of a row of the sform

}  // namespace raycone::nifti
