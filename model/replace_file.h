#pragma once
#include <filesystem>

/// Files that are made beside the one that they replace, so that neither a kill nor a loss of power leaves half of one.
namespace grouser {

/// What this program calls by a name of its own inside an output folder stands there: throws FileError where `place` is
/// a symbolic link, which may lead anywhere.
void refuse_link(const std::filesystem::path& place);

/// Returns once the file's bytes stand on the disk. Throws FileError.
void sync_file(const std::filesystem::path& file);

/// Gives `made` the name `file`, in place of what bears it; both in one folder. Whenever power is lost, `file` is the
/// old one or the new one, whole. Throws FileError, and leaves both as they were.
void replace_file(const std::filesystem::path& made, const std::filesystem::path& file);

/// Ditto for folders; files below `made` must be on the disk already. What bore the name is removed: where that cannot
/// be done FileError or filesystem_error is thrown after the exchange, and the old folder is `made`. On a file system
/// that cannot exchange two names a kill may leave the old folder as `made`.old, and no `folder`.
void replace_folder(const std::filesystem::path& made, const std::filesystem::path& folder);

}  // namespace grouser
