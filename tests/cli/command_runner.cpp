#include "tests/cli/command_runner.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

#include "tests/support/temporary_folder.h"

namespace grouser::test {
namespace {

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

void redirect(int descriptor, const std::string& file) {
  const int opened = open(file.c_str(), O_WRONLY | O_CREAT, 0644);
  if (opened < 0 || dup2(opened, descriptor) < 0) _exit(126);
}

pid_t start(const std::vector<std::string>& arguments, const std::string& out, const std::string& err,
            const std::vector<int>& closed) {
  const pid_t process = fork();
  if (process != 0) return process;
  redirect(STDOUT_FILENO, out);
  redirect(STDERR_FILENO, err);
  std::vector<std::string> words{GROUSER_COMMAND};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  for (const int stream : closed) close(stream);
  execv(pointers.front(), pointers.data());
  _exit(127);
}

}  // namespace

CommandOutput grouser(const std::vector<std::string>& arguments, const CommandControl& control) {
  const TemporaryFolder folder;
  const std::string out = control.stdout_file.empty() ? (folder / "out").string() : control.stdout_file;
  const std::string err = (folder / "err").string();
  const pid_t process = start(arguments, out, err, control.closed);
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::minutes(8);
  bool signalled = control.signal == 0;
  int status = 0;
  while (waitpid(process, &status, WNOHANG) == 0) {
    if (!signalled && text_of(err).find(control.signal_after) != std::string::npos) {
      signalled = true;
      kill(process, control.signal);
    }
    if (std::chrono::steady_clock::now() > give_up) kill(process, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  CommandOutput output;
  output.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  if (control.stdout_file.empty()) output.out = text_of(out);
  output.err = text_of(err);
  return output;
}

}  // namespace grouser::test
