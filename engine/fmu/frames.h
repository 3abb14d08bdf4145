// How the shared library of an FMU and the program that computes talk: messages over a socket, each a kind, its length and numbers or
// text. Both run on one machine, so numbers go as they lie in memory.
#pragma once

#include <sys/socket.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dynoproof::fmu {

/// The descriptor at which the program finds its socket.
inline constexpr int kSocket = 3;

enum Kind : std::uint32_t {
  // Questions. Each has one answer.
  kDescribe = 1,  // -> kNumbers: period [s], how many inputs, outputs and parameters, what each of these begins with
  kBegin,         // the inputs at t = 0, the parameters -> kNumbers: the outputs at t = 0
  kStep,          // how many periods, the inputs that are held meanwhile -> kNumbers: the outputs at the end
  // Answers.
  kNumbers,
  kFault,  // text
};

struct Message {
  std::uint32_t kind = 0;
  std::vector<char> bytes = {};

  std::vector<double> Numbers() const {
    std::vector<double> numbers(bytes.size() / sizeof(double));
    std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(double));
    return numbers;
  }
  std::string Text() const { return {bytes.begin(), bytes.end()}; }
};

/// Whether all bytes were sent. A partner that is gone is no signal.
inline bool SendBytes(int socket, const char* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t sent = ::send(socket, bytes, size, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    bytes += sent;
    size -= static_cast<std::size_t>(sent);
  }
  return true;
}

inline bool ReceiveBytes(int socket, char* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t came = ::recv(socket, bytes, size, 0);
    if (came < 0 && errno == EINTR) continue;
    if (came <= 0) return false;
    bytes += came;
    size -= static_cast<std::size_t>(came);
  }
  return true;
}

inline bool Send(int socket, Kind kind, std::string_view bytes) {
  const std::uint32_t head[2] = {kind, static_cast<std::uint32_t>(bytes.size())};
  return SendBytes(socket, reinterpret_cast<const char*>(head), sizeof(head)) &&
         SendBytes(socket, bytes.data(), bytes.size());
}

inline bool Send(int socket, Kind kind, std::span<const double> numbers) {
  return Send(socket, kind, std::string_view(reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()));
}

inline bool Receive(int socket, Message& message) {
  std::uint32_t head[2];
  if (!ReceiveBytes(socket, reinterpret_cast<char*>(head), sizeof(head))) return false;
  message.kind = head[0];
  message.bytes.resize(head[1]);
  return ReceiveBytes(socket, message.bytes.data(), message.bytes.size());
}

}  // namespace dynoproof::fmu
