// Memory for integers of any size.
#pragma once

namespace raycone {

// GMP ends the process where it gets no memory. From this call on it takes numbers of up to 1 kB from a reserve of 512
// kB then, so that whoever allocates next is told (std::bad_alloc); larger ones still end the process. For all of the
// process; call once, before other threads run.
void reserve_memory_for_integers();

}  // namespace raycone
