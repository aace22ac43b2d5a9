# The Rust target of the processor that a toolchain file names.
#
# | CMAKE_SYSTEM_PROCESSOR, or -mcpu= in the flags | target |
# |---|---|
# | cortex-m0, cortex-m0plus, cortex-m1 | thumbv6m-none-eabi |
# | cortex-m3 | thumbv7m-none-eabi |
# | cortex-m4, cortex-m7 | thumbv7em-none-eabi, with -mfloat-abi=hard thumbv7em-none-eabihf |
# | cortex-m23 | thumbv8m.base-none-eabi |
# | cortex-m33, m35p, m52, m55, m85 | thumbv8m.main-none-eabi, with -mfloat-abi=hard thumbv8m.main-none-eabihf |
# | riscv32 with -march=rv32imac, rv32imc, rv32imafc | riscv32imac-, riscv32imc-, riscv32imafc-unknown-none-elf |
# | x86_64, aarch64, armv7l with Linux | the target of that system |
#
# Every other processor is an error, because a library of another processor would link or crash later.

# Sets `result` to the target; empty for the host, and if RAI_TARGET is named already.
function(rai_derive_target result)
    set(${result} "" PARENT_SCOPE)
    if(NOT "${RAI_TARGET}" STREQUAL "" OR NOT CMAKE_CROSSCOMPILING)
        return()
    endif()
    get_directory_property(options COMPILE_OPTIONS)
    set(flags "${CMAKE_C_FLAGS_INIT} ${CMAKE_C_FLAGS} ${options}")
    string(TOLOWER "${CMAKE_SYSTEM_PROCESSOR}" processor)
    if(NOT processor MATCHES "cortex-m" AND flags MATCHES "-mcpu=(cortex-m[0-9a-z+]+)")
        set(processor ${CMAKE_MATCH_1})
    endif()
    set(hard "")
    if(flags MATCHES "-mfloat-abi=hard")
        set(hard "hf")
    endif()
    if(CMAKE_SYSTEM_NAME STREQUAL "Linux")
        rai_linux_target("${processor}" target)
    elseif(processor MATCHES "^cortex-m(0|0plus|0\\+|1)(\\+.*)?$")
        set(target thumbv6m-none-eabi)
    elseif(processor MATCHES "^cortex-m3$")
        set(target thumbv7m-none-eabi)
    elseif(processor MATCHES "^cortex-m[47](\\+.*)?$")
        set(target thumbv7em-none-eabi${hard})
    elseif(processor MATCHES "^cortex-m23$")
        set(target thumbv8m.base-none-eabi)
    elseif(processor MATCHES "^cortex-m(33|35p|52|55|85)(\\+.*)?$")
        set(target thumbv8m.main-none-eabi${hard})
    elseif(processor MATCHES "^(riscv|riscv32|rv32.*)$")
        rai_riscv_target("${processor} ${flags}" target)
    else()
        set(target "")
    endif()
    if(target STREQUAL "")
        message(FATAL_ERROR
            "rai: no Rust target is known for CMAKE_SYSTEM_NAME \"${CMAKE_SYSTEM_NAME}\" with CMAKE_SYSTEM_PROCESSOR "
            "\"${CMAKE_SYSTEM_PROCESSOR}\" and the flags \"${flags}\". Name the processor in the toolchain file as "
            "cmake/target.cmake lists it, or the target itself: -DRAI_TARGET=thumbv7em-none-eabihf.")
    endif()
    message(STATUS "rai: Rust target ${target} (rustup target add ${target})")
    set(${result} ${target} PARENT_SCOPE)
endfunction()

function(rai_linux_target processor result)
    set(target "")
    if(processor MATCHES "^(x86_64|amd64)$")
        set(target x86_64-unknown-linux-gnu)
    elseif(processor MATCHES "^(aarch64|arm64)$")
        set(target aarch64-unknown-linux-gnu)
    elseif(processor MATCHES "^armv7")
        set(target armv7-unknown-linux-gnueabihf)
    endif()
    set(${result} "${target}" PARENT_SCOPE)
endfunction()

function(rai_riscv_target text result)
    set(target "")
    if(text MATCHES "rv32imafd?c" AND text MATCHES "-mabi=ilp32f")
        set(target riscv32imafc-unknown-none-elf)
    elseif(NOT text MATCHES "-mabi=ilp32[fd]" AND text MATCHES "rv32im(a?)c")
        # The last match is that of the architecture.
        set(target riscv32im${CMAKE_MATCH_1}c-unknown-none-elf)
    endif()
    set(${result} "${target}" PARENT_SCOPE)
endfunction()
