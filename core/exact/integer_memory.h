// Memory for integers of any size.
#pragma once

namespace raycone {

// GMP ends the process where it gets no memory. After this call it takes numbers of up to 1 kB from a reserve of 512 kB
// instead. So the next allocation elsewhere finds out, and throws std::bad_alloc. Larger numbers still end the process,
// and so does a reserve that is used up. For the whole process: call it once, before other threads run.
void reserve_memory_for_integers();

}  // namespace raycone
