// The renderer in a thread of its own: the window never waits for it, and a lost device takes nothing of the user's
// with it. It has a device of its own, or is the second user of the window's. A mailbox lies between them.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "live/engine.h"
#include "live/published.h"
#include "live/wanted.h"

namespace nf::editor::live {

class Worker {
 public:
  explicit Worker(const WorkerOptions& options);
  ~Worker();  // finishes the frame in hand
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  void want(const Wanted& wanted);
  void send(Command command);
  // The newest frame that was not taken yet.
  std::optional<Published> take();
  std::vector<Event> take_events();
  // Nothing is being done or waits to be done.
  bool idle() const;
  // Of validation, since the start.
  uint64_t messages() const;
  // Before the window's device is closed: returns when the renderer has nothing of it left, and frames that were not
  // taken are gone. It has no device until lend() and CommandKind::Restart.
  void release();
  void lend(Handover& handover);

 private:
  void run();
  bool has_work(const Engine& engine) const;
  void reload(Engine& engine, const std::vector<std::string>& changed);
  void publish(Published&& frame);
  void tell(Event event);
  // Runs `work`; what it throws becomes an event, and false comes back.
  template <class Work>
  bool guarded(Engine& engine, const Work& work);

  WorkerOptions options_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  // Under the mutex:
  Wanted wanted_;
  std::vector<Command> commands_;
  std::optional<Published> published_;
  std::vector<Event> events_;
  bool quit_ = false, busy_ = true, release_ = false;
  uint64_t messages_ = 0;
  std::thread thread_;  // last: starts when all else is there
};

}  // namespace nf::editor::live
