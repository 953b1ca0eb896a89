// Memory that a process does not need while it waits.
#pragma once

namespace mottle {

/// Gives the system back what is free of the heap, and the pages of programs and libraries that nobody writes to: those
/// that are needed again are read again. Most of them were read once, by the start of libraries (of OpenTURNS' 40 MB).
/// For a process that is about to wait for long. Breakpoints that a debugger has set in code go with its pages.
void release_idle_memory();

}  // namespace mottle
