#include "daemon/study/gnuplot.hpp"

#include <stdexcept>
#include <string>

#include <sys/wait.h>
#include <unistd.h>

namespace dwell {

void run_gnuplot(const std::filesystem::path& directory, const char* script) {
  const pid_t child = fork();
  if (child == 0) {
    if (chdir(directory.c_str()) == 0) execlp("gnuplot", "gnuplot", script, static_cast<char*>(nullptr));
    _exit(127);
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child || status != 0) {
    throw std::runtime_error(WIFEXITED(status) && WEXITSTATUS(status) == 127
                                 ? "gnuplot is missing: the plots are not drawn, their data and scripts are there"
                                 : std::string("gnuplot failed on ") + script);
  }
}

}  // namespace dwell
