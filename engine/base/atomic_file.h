// Files that appear under their name whole or not at all.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>

#include "base/status.h"

namespace dynoproof {

/// Writes `bytes` to `path` so that a reader, a crash or a full disk at any moment finds either the previous file or
/// the complete new one: a hidden temporary file in the same folder is written, synchronised with the disk, renamed
/// over `path`, and the folder is synchronised.
///
/// Missing folders are created. A symbolic link keeps pointing where it did: the file behind it is replaced. A device
/// or pipe (`/dev/stdout`) is written to directly, as there is nothing to replace. Writers of one path at the same time
/// do not disturb each other; the last rename wins.
///
/// Failure (exit code 3, `signal` = the path): the folder cannot be made or written, the disk is full, the path is a
/// folder. The temporary file is removed then, and what was under `path` is untouched. Only a killed process leaves
/// one behind, named `.<name>.<random>.part`; the next one that writes `path` a minute later removes it.
Status WriteFileAtomically(const std::filesystem::path& path, std::span<const std::byte> bytes);

/// The same where nothing stands under `path` yet; what stands there, or comes meanwhile, stays.
Status CreateFileAtomically(const std::filesystem::path& path, std::span<const std::byte> bytes);

/// The same for text.
Status WriteFileAtomically(const std::filesystem::path& path, std::string_view text);

}  // namespace dynoproof
