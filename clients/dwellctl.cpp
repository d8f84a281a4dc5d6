// dwellctl: commands dwelld and shows what it does.
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <iostream>
#include <variant>

#include "clients/command_line.hpp"
#include "clients/commands.hpp"
#include "clients/control_client.hpp"
#include "clients/terminal.hpp"
#include "clients/watch.hpp"

namespace dwell::client {
namespace {

constexpr int kFailed = 1;

int run(CommandLine line) {
  line.control.client = client_name();
  zmq::context_t context;
  if (line.verb == Verb::kWatch) return watch(context, line.stream, line.control, line.json);
  Page page = terminal_page();
  if (page.rows != kUnlimited) --page.rows;  // the prompt comes back below the answer
  ControlClient control(context, line.control);
  const int code = run_command(line, control, {std::cout, std::cerr, page, wants_colour()});
  if (!std::cout.flush()) throw std::runtime_error("cannot write to standard output");
  return code;
}

}  // namespace
}  // namespace dwell::client

int main(int argc, char** argv) {
  try {
    auto parsed = dwell::client::parse_command_line(argc, argv);
    if (const int* code = std::get_if<int>(&parsed)) return *code;
    return dwell::client::run(std::get<dwell::client::CommandLine>(std::move(parsed)));
  } catch (const std::exception& error) {
    fmt::print(stderr, "dwellctl: {}\n", error.what());
    return dwell::client::kFailed;
  }
}
