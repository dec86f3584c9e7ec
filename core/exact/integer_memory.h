// Memory for integers of any size.
#pragma once

namespace raycone {

// GMP ends the process where it gets no memory. From this call on it takes numbers of up to 1 kB from a reserve then,
// so that whoever allocates next is told (std::bad_alloc). For all of the process; call once, before the first number.
void reserve_memory_for_integers();

}  // namespace raycone
