#include "core/cli/stop_signal.h"

#include <csignal>

namespace sightline {
namespace {

// A signal handler reaches nothing but globals.
std::atomic<bool> stop_requested{false};
volatile std::sig_atomic_t stop_signal = 0;

void setHandler(void (*handler)(int)) {
  std::signal(SIGINT, handler);
  std::signal(SIGTERM, handler);
}

void handle(int signal) {
  stop_signal = signal;
  stop_requested = true;
  setHandler(SIG_DFL);
}

}  // namespace

StopSignal::StopSignal() {
  setHandler(handle);
}
StopSignal::~StopSignal() {
  setHandler(SIG_DFL);
}
const std::atomic<bool>* StopSignal::flag() const {
  return &stop_requested;
}
int StopSignal::exitCode() const {
  return stop_signal == 0 ? 0 : 128 + stop_signal;
}

}  // namespace sightline
