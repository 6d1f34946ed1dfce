# Compile options of this project's own targets; nothing here reaches a dependency's headers.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

add_library(stickslip_options INTERFACE)

# No -ffast-math: results must not depend on how the compiler reorders sums. No contraction to
# fused multiply-add for the same reason: the source says where (`fma`). No link-time optimisation:
# the kernels of several processors have to stay apart.
target_compile_options(stickslip_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion
  -ffp-contract=off
  # Masks are one number or a pack of them, and both sides of an operator are worked out.
  $<$<CXX_COMPILER_ID:Clang,AppleClang>:-Wno-bitwise-instead-of-logical>
  # Straight-line vectorisation packs what the stages of an integrator wrote one by one, and waits.
  $<$<CONFIG:Release>:-O3 -fno-math-errno -fno-tree-vectorize>
)

if(EMSCRIPTEN)
  # Exceptions of WebAssembly itself: half the size of those that go through JavaScript.
  target_compile_options(stickslip_options INTERFACE -fwasm-exceptions)
  target_link_options(stickslip_options INTERFACE -fwasm-exceptions)
endif()

if(STICKSLIP_SANITIZE)
  target_compile_options(stickslip_options INTERFACE
    -fsanitize=${STICKSLIP_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(stickslip_options INTERFACE -fsanitize=${STICKSLIP_SANITIZE})
endif()
