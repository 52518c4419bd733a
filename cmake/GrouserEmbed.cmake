# grouser_embed(TARGET SYMBOL FILE): the file's bytes as `extern "C" const char SYMBOL_begin[], SYMBOL_end[]` in read-only memory.
function(grouser_embed target symbol file)
  set(SYM ${symbol})
  set(FILE ${file})
  configure_file(${CMAKE_SOURCE_DIR}/cmake/embed.S.in ${CMAKE_CURRENT_BINARY_DIR}/${symbol}.S @ONLY)
  set_source_files_properties(${CMAKE_CURRENT_BINARY_DIR}/${symbol}.S PROPERTIES OBJECT_DEPENDS ${file})
  target_sources(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/${symbol}.S)
endfunction()
