#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

/// Files that are made beside the one that they replace, so that neither a kill nor a loss of power leaves half of one.
namespace grouser {

/// What this program calls by a name of its own inside an output folder stands there: throws FileError where `place` is
/// a symbolic link, which may lead anywhere, or neither a file nor a folder.
void require_own(const std::filesystem::path& place);

/// Ditto for a file that is written in place: throws also where it has another name, which would be written, too.
void require_own_file(const std::filesystem::path& file);

/// Throws FileError where what bears the name is a pipe, a device or a socket: a file would replace it.
void refuse_device(const std::filesystem::path& file);

/// Ditto, also for a folder: where no file could be put.
void require_place_of_file(const std::filesystem::path& file);

/// Throws FileError where one of `made`, which a command is about to write, is one of `read`, which it was given.
void require_apart(const std::vector<std::filesystem::path>& made, const std::vector<std::filesystem::path>& read);

/// Throws FileError where `folder` takes no new file of `bytes`, for want of permission or space, before anything that
/// is there is touched. A file system that knows no files without a name is not asked.
void require_room(const std::filesystem::path& folder, std::uintmax_t bytes);

/// Returns once the file's bytes stand on the disk. Throws FileError.
void sync_file(const std::filesystem::path& file);

/// Gives `made` the name `file`, in place of what bears it; both in one folder. Whenever power is lost, `file` is the
/// old one or the new one, whole. Throws FileError, also for refuse_device, and leaves both as they were.
void replace_file(const std::filesystem::path& made, const std::filesystem::path& file);

/// Ditto for folders; files below `made` must be on the disk already. What bore the name is removed: where that cannot
/// be done FileError or filesystem_error is thrown after the exchange, and the old folder is `made`. On a file system
/// that cannot exchange two names a kill may leave the old folder as `made`.old, and no `folder`.
void replace_folder(const std::filesystem::path& made, const std::filesystem::path& folder);

}  // namespace grouser
