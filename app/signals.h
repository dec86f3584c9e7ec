// Signals and inherited descriptors of the process: interrupted runs leave no debris and die as their caller expects.
#pragma once

#include <string>

namespace raycone {

// Call once, first thing. SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU and SIGPIPE remove temporary files, then kill the
// process (the first four stay ignored where they were inherited so, as under nohup); a file-size limit becomes a write
// error; closed standard descriptors are occupied, so that no file is opened in their place.
void set_up_process();

// Ends the process with status 4 and a message about `name` after so many seconds.
void start_timeout(double seconds, const std::string& name);

}  // namespace raycone
