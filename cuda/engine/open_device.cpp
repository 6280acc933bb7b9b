// SPDX-License-Identifier: Apache-2.0
// Opens the first device and checks that it can run batches.
#include "cuda/engine/engine_parts.hpp"

namespace axg::cuda {
namespace {

bool failed(cudaError_t error, const char* what, std::string& fault) {
    if (error == cudaSuccess) {
        return false;
    }
    fault = std::string(what) + ": " + cudaGetErrorString(error);
    return true;
}

}  // namespace

bool open_device(CudaDevice& device, std::string& fault) {
    int count = 0;
    cudaDeviceProp properties{};
    if (failed(cudaGetDeviceCount(&count), "no CUDA device", fault)) {
        fault += "; use --engine cpu";
        return false;
    }
    if (failed(cudaSetDeviceFlags(cudaDeviceScheduleSpin | cudaDeviceMapHost), "device flags",
               fault) ||
        failed(cudaSetDevice(0), "device 0", fault) || failed(cudaFree(nullptr), "start", fault) ||
        failed(cudaGetDeviceProperties(&properties, 0), "device properties", fault)) {
        return false;
    }
    int timeout = 0, clock_khz = 0;
    if (failed(cudaDeviceGetAttribute(&timeout, cudaDevAttrKernelExecTimeout, 0), "attributes",
               fault) ||
        failed(cudaDeviceGetAttribute(&clock_khz, cudaDevAttrClockRate, 0), "clock", fault) ||
        failed(cudaDriverGetVersion(&device.driver), "driver version", fault) ||
        failed(cudaRuntimeGetVersion(&device.runtime), "runtime version", fault)) {
        return false;
    }
    if (timeout != 0) {
        fault = "the GPU drives a display, whose watchdog ends long kernels; use one without";
        return false;
    }
    device.name = properties.name;
    device.multiprocessors = static_cast<unsigned>(properties.multiProcessorCount);
    device.clock_khz = static_cast<unsigned>(clock_khz);
    return true;
}

}  // namespace axg::cuda
