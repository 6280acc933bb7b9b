// SPDX-License-Identifier: Apache-2.0
// A partition of a large GPU replaces a small one: a green context of N multiprocessors. Looks the
// driver's entry points up at run time, so no binary links against the driver.
#include <cuda.h>

#include "cuda/engine/engine_parts.hpp"

namespace axg::cuda {
namespace {

template <class Function>
bool find_entry(const char* name, Function& out) {
    void* address = nullptr;
    cudaDriverEntryPointQueryResult found = cudaDriverEntryPointSymbolNotFound;
    // Green contexts came with 12.4, their streams with 12.5.
    if (cudaGetDriverEntryPointByVersion(name, &address, 12050, cudaEnableDefault, &found) !=
            cudaSuccess ||
        found != cudaDriverEntryPointSuccess) {
        return false;
    }
    out = reinterpret_cast<Function>(address);
    return true;
}

struct GreenCalls {
    decltype(&cuDeviceGetDevResource) get = nullptr;
    decltype(&cuDevSmResourceSplitByCount) split = nullptr;
    decltype(&cuDevResourceGenerateDesc) describe = nullptr;
    decltype(&cuGreenCtxCreate) create = nullptr;
    decltype(&cuGreenCtxStreamCreate) stream = nullptr;
};

bool make_green(const GreenCalls& calls, unsigned wanted, Partition& out) {
    CUdevResource all{}, part{}, rest{};
    CUdevResourceDesc description{};
    unsigned groups = 1;
    CUgreenCtx green{};
    CUstream stream{};
    if (calls.get(0, &all, CU_DEV_RESOURCE_TYPE_SM) != CUDA_SUCCESS ||
        calls.split(&part, &groups, &all, &rest, 0, wanted) != CUDA_SUCCESS || groups != 1 ||
        calls.describe(&description, &part, 1) != CUDA_SUCCESS ||
        calls.create(&green, description, 0, CU_GREEN_CTX_DEFAULT_STREAM) != CUDA_SUCCESS ||
        calls.stream(&stream, green, CU_STREAM_NON_BLOCKING, 0) != CUDA_SUCCESS) {
        return false;
    }
    out = {green, stream, part.sm.smCount};
    return true;
}

}  // namespace

bool make_partition(unsigned wanted, Partition& out, std::string& fault) {
    int present = 0;
    if (cudaDeviceGetAttribute(&present, cudaDevAttrMultiProcessorCount, 0) != cudaSuccess) {
        fault = "the GPU does not tell how many multiprocessors it has";
        return false;
    }
    if (wanted == 0) {
        out = {nullptr, nullptr, static_cast<unsigned>(present)};
        if (cudaStreamCreateWithFlags(&out.stream, cudaStreamNonBlocking) != cudaSuccess) {
            fault = "the GPU gave no stream";
            return false;
        }
        return true;
    }
    GreenCalls calls;
    if (!find_entry("cuDeviceGetDevResource", calls.get) ||
        !find_entry("cuDevSmResourceSplitByCount", calls.split) ||
        !find_entry("cuDevResourceGenerateDesc", calls.describe) ||
        !find_entry("cuGreenCtxCreate", calls.create) ||
        !find_entry("cuGreenCtxStreamCreate", calls.stream)) {
        fault = "the driver has no green contexts; leave out --sms, or install one for CUDA 12.5";
        return false;
    }
    if (!make_green(calls, wanted, out)) {
        fault = "the GPU gave no partition of " + std::to_string(wanted) +
                " multiprocessors; it has " + std::to_string(present) +
                ", and large ones are cut in steps of eight";
        return false;
    }
    return true;
}

void close_partition(const Partition& partition) noexcept {
    static_cast<void>(cudaStreamDestroy(partition.stream));
    decltype(&cuGreenCtxDestroy) destroy = nullptr;
    if (partition.green != nullptr && find_entry("cuGreenCtxDestroy", destroy)) {
        static_cast<void>(destroy(static_cast<CUgreenCtx>(partition.green)));
    }
}

}  // namespace axg::cuda
