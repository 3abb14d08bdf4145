// A real Slurm cluster of four nodes on the loopback: own configuration, own munge, no system service, gone with the
// object. Works as root and as an ordinary user.
#pragma once

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <pwd.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>
#include <thread>

#include "tests/support/program.h"

namespace dynoproof::test {

class SlurmCluster {
 public:
  static constexpr int kNodes = 4;

  /// Whether the packages are there.
  static bool Installed() {
    for (const char* program : {"/usr/sbin/munged", "/usr/sbin/slurmctld", "/usr/sbin/slurmd", "/usr/bin/sbatch"}) {
      if (::access(program, X_OK) != 0) return false;
    }
    return true;
  }

  SlurmCluster() {
    namespace fs = std::filesystem;
    fs::permissions(folder_.path(), fs::perms(0755));
    for (const char* name : {"etc", "run", "log", "state", "spool", "tmp"}) Make(name, 0755);
    Make("munge", 0700);
    for (int node = 1; node <= kNodes; ++node) {
      Make("spool/n" + std::to_string(node), 0755);
      Make("tmp/n" + std::to_string(node), 0755);
    }
    std::string key(1024, '\0');
    if (::getrandom(key.data(), key.size(), 0) != 1024) throw std::runtime_error("no random numbers");
    folder_.Write("munge/key", key);
    fs::permissions(folder_ / "munge/key", fs::perms(0600));
    folder_.Write("etc/plugstack.conf", "");
    folder_.Write("etc/slurm.conf", Configuration());
    ::setenv("SLURM_CONF", (folder_ / "etc/slurm.conf").c_str(), 1);
    munged_ = Start({"/usr/sbin/munged", "-F", "--key-file=" + (folder_ / "munge/key").string(), "--socket=" + Socket(),
                     "--pid-file=" + (folder_ / "run/munged.pid").string(),
                     "--log-file=" + (folder_ / "munge/munged.log").string(),
                     "--seed-file=" + (folder_ / "munge/seed").string()});
    WaitFor([&] { return fs::exists(Socket()); }, "munged");
    controller_ = Start({"/usr/sbin/slurmctld", "-D", "-c"});
    for (int node = 1; node <= kNodes; ++node)
      nodes_.push_back(Start({"/usr/sbin/slurmd", "-D", "-N", "n" + std::to_string(node)}));
    WaitFor(
        [&] {
          std::istringstream states(Ask({"-h", "-N", "-o", "%T"}, "sinfo"));
          int idle = 0;
          for (std::string state; states >> state;) idle += state == "idle" ? 1 : 0;
          return idle == kNodes;
        },
        "four idle nodes");
  }

  ~SlurmCluster() {
    Ask({"--quiet", "--user=" + User()}, "scancel");
    Stop(controller_);
    for (const pid_t node : nodes_) Stop(node);
    for (int node = 1; node <= kNodes; ++node) SweepNode("n" + std::to_string(node));
    Stop(munged_);
  }
  SlurmCluster(const SlurmCluster&) = delete;
  SlurmCluster& operator=(const SlurmCluster&) = delete;

  /// What a client needs.
  std::map<std::string, std::string> Environment() const {
    return {{"SLURM_CONF", (folder_ / "etc/slurm.conf").string()}};
  }

  /// Holds still what runs on a node (SIGSTOP) or lets it go on (SIGCONT); the numbers of the array tasks found there.
  std::set<int> SignalTasks(int node, int signal) const {
    std::set<int> tasks;
    for (const Process& process : ProcessesOf("n" + std::to_string(node))) {
      const std::string key = "SLURM_ARRAY_TASK_ID=";
      const std::size_t at = process.environment.find(key);
      if (::kill(process.id, signal) == 0 && at != std::string::npos)
        tasks.insert(std::atoi(process.environment.c_str() + at + key.size()));
    }
    return tasks;
  }

  /// Pulls the plug of a node: its daemon and all that runs there die at once.
  void Kill(int node) {
    ::kill(-nodes_[static_cast<std::size_t>(node - 1)], SIGKILL);
    SweepNode("n" + std::to_string(node));
  }

  /// Waits until the controller says of a node that it is in a state; what it says last.
  std::string AwaitState(const std::string& node_and_state) const {
    std::string said;
    for (int i = 0; i < 300; ++i) {
      said = Ask({"-h", "-N", "-o", "%N %T"}, "sinfo");
      if (said.find(node_and_state) != std::string::npos) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return said;
  }

  std::string Ask(const std::vector<std::string>& arguments, const std::string& program) const {
    return Call(arguments, {.environment = Environment(), .program = program}).out;
  }

 private:
  std::string Socket() const { return (folder_ / "run/munge.socket").string(); }
  static std::string User() {
    const passwd* me = ::getpwuid(::getuid());
    return me != nullptr ? me->pw_name : std::to_string(::getuid());
  }
  void Make(const std::string& name, int mode) const {
    std::filesystem::create_directories(folder_ / name);
    std::filesystem::permissions(folder_ / name, std::filesystem::perms(mode));
  }

  /// The first of `count` ports in a row that nobody has.
  static int FreePorts(int count) {
    for (int base = 20000 + static_cast<int>(::getpid() % 2000) * 16; base < 64000; base += 16) {
      int good = 0;
      for (int port = base; port < base + count; ++port) {
        const int probe = ::socket(AF_INET, SOCK_STREAM, 0);
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(static_cast<std::uint16_t>(port));
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        good += ::bind(probe, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0 ? 1 : 0;
        ::close(probe);
      }
      if (good == count) return base;
    }
    throw std::runtime_error("no free ports");
  }

  std::string Configuration() const {
    const std::string dir = folder_.path().string(), me = User();
    const int base = FreePorts(kNodes + 1);
    std::ostringstream text;
    text << "ClusterName=test\nSlurmctldHost=localhost(127.0.0.1)\nSlurmctldPort=" << base << "\nSlurmUser=" << me
         << "\nSlurmdUser=" << me << "\nAuthType=auth/munge\nCredType=cred/munge\nAuthInfo=socket=" << Socket()
         << ",cred_expire=5\nCommunicationParameters=NoCtldInAddrAny,NoInAddrAny\nStateSaveLocation=" << dir
         << "/state\nSlurmdSpoolDir=" << dir << "/spool/%n\nTmpFS=" << dir << "/tmp/%n\nPlugStackConfig=" << dir
         << "/etc/plugstack.conf\nSlurmctldPidFile=" << dir << "/run/slurmctld.pid\nSlurmdPidFile=" << dir
         << "/run/slurmd.%n.pid\nSlurmctldLogFile=" << dir << "/log/slurmctld.log\nSlurmdLogFile=" << dir
         << "/log/slurmd.%n.log\n"
         << "ProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nMpiDefault=none\n"
            "SelectType=select/cons_tres\nSelectTypeParameters=CR_CPU\nSlurmdParameters=config_overrides\n"
            "JobAcctGatherType=jobacct_gather/none\nAccountingStorageType=accounting_storage/none\n"
            "JobCompType=jobcomp/none\nSchedulerType=sched/backfill\n"
            "SchedulerParameters=batch_sched_delay=0,sched_min_interval=0,sched_interval=1,bf_interval=1\n"
            "SlurmdTimeout=5\nSlurmctldTimeout=10\nMessageTimeout=5\nKillWait=2\nMinJobAge=3600\n"
            "ReturnToService=1\nJobRequeue=1\nRequeueExit=75\nJobFileAppend=1\nEnforcePartLimits=ALL\n"
         << "NodeName=n[1-" << kNodes << "] NodeHostname=localhost NodeAddr=127.0.0.1 Port=[" << base + 1 << "-"
         << base + kNodes
         << "] CPUs=2 RealMemory=1000 State=UNKNOWN\n"
            "PartitionName=ci Nodes=ALL Default=YES MaxTime=60 DefaultTime=10 DefMemPerCPU=100 State=UP\n";
    return text.str();
  }

  /// A daemon in a session of its own.
  pid_t Start(std::vector<std::string> words) const {
    const pid_t child = ::fork();
    if (child != 0) return child;
    ::setsid();
    const int log = ::open((folder_ / "log/daemons.log").c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
    ::dup2(::open("/dev/null", O_RDONLY), STDIN_FILENO);
    ::dup2(log, STDOUT_FILENO);
    ::dup2(log, STDERR_FILENO);
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    ::execv(arguments[0], arguments.data());
    ::_exit(127);
  }

  static void Stop(pid_t process) {
    if (process <= 0) return;
    ::kill(process, SIGTERM);
    for (int i = 0; i < 100; ++i) {
      if (::waitpid(process, nullptr, WNOHANG) != 0) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    ::kill(-process, SIGKILL);
    ::waitpid(process, nullptr, 0);
  }

  struct Process {
    pid_t id;
    std::string environment;
  };
  /// Step managers and tasks leave their daemon's session: they are found by what they inherited from this cluster.
  std::vector<Process> ProcessesOf(const std::string& node) const {
    const std::string mine = folder_.path().string();
    std::vector<Process> found;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
      const int process = std::atoi(entry.path().filename().c_str());
      if (process <= 1 || process == ::getpid()) continue;
      const std::string words = ReadBytes(entry.path() / "cmdline"), environment = ReadBytes(entry.path() / "environ");
      const bool of_task = environment.find(mine) != std::string::npos &&
                           environment.find("SLURMD_NODENAME=" + node + '\0') != std::string::npos;
      const bool of_step = words.starts_with("slurmstepd") && environment.find(mine) != std::string::npos &&
                           environment.find("SLURM_NODE_ALIASES") == std::string::npos && StepOf(entry.path(), node);
      if (of_task || of_step) found.push_back({process, environment});
    }
    return found;
  }
  /// Kills them, and what they started meanwhile.
  void SweepNode(const std::string& node) const {
    for (int round = 0; round < 3; ++round) {
      for (const Process& process : ProcessesOf(node)) ::kill(process.id, SIGKILL);
    }
  }
  /// A step manager holds files of its node's spool or log open.
  bool StepOf(const std::filesystem::path& process, const std::string& node) const {
    std::error_code error, unread;  // it may end meanwhile
    for (std::filesystem::directory_iterator link(process / "fd", error), end; !error && link != end;
         link.increment(error)) {
      const std::string target = std::filesystem::read_symlink(link->path(), unread).string();
      if (target.find("/slurmd." + node + ".log") != std::string::npos) return true;
      if (target.find("/spool/" + node + "/") != std::string::npos) return true;
    }
    return false;
  }

  template <class Ready>
  void WaitFor(const Ready& ready, const char* what) const {
    for (int i = 0; i < 300; ++i) {
      if (ready()) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    throw std::runtime_error(std::string("the cluster did not get to: ") + what + "\n" +
                             ReadBytes(folder_ / "log/daemons.log") + ReadBytes(folder_ / "log/slurmctld.log"));
  }

  TempDir folder_;
  pid_t munged_ = 0, controller_ = 0;
  std::vector<pid_t> nodes_;
};

}  // namespace dynoproof::test
