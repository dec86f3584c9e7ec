// Prints what documents the command line elsewhere than in its help: raycone_manual man|bash|zsh. Part of the build,
// not of the installation.
#include <iostream>
#include <string>

#include "app/manual/completion.h"
#include "app/manual/manual_page.h"

int main(int argc, char** argv) {
  using namespace raycone;
  const std::string what = argc == 2 ? argv[1] : "";
  if (what == "man") {
    std::cout << manual_page();
  } else if (what == "bash") {
    std::cout << bash_completion();
  } else if (what == "zsh") {
    std::cout << zsh_completion();
  } else {
    std::cerr << "usage: raycone_manual man|bash|zsh\n";
    return 1;
  }
  return std::cout.flush() ? 0 : 1;
}
