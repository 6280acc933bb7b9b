// SPDX-License-Identifier: GPL-2.0-or-later
#include "firmware_if/linuxcnc/axguard_bus.h"

#include <errno.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#define ASK_US 50000     // between two messages of a panel
#define HEARD_US 500000  // the guard sends its status every 100 ms
#define PRESSED_US 5000000

static bool fail(axg_bus* bus, char* fault, unsigned fault_bytes, const char* interface,
                 const char* what) {
    snprintf(fault, fault_bytes, "%s: %s: %s. Set it up: ip link set %s up", interface, what,
             strerror(errno), interface);
    axg_bus_close(bus);
    return false;
}

bool axg_bus_open(axg_bus* bus, const char* interface, const axg_terms* terms, char* fault,
                  unsigned fault_bytes) {
    memset(bus, 0, sizeof *bus);
    bus->operator_in_id = terms->operator_in_id;
    bus->operator_out_id = terms->operator_out_id;
    bus->socket = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
    if (bus->socket < 0) {
        return fail(bus, fault, fault_bytes, interface, "no CAN socket");
    }
    const uint32_t ids[] = {terms->permit_id, terms->permit_id + 1, terms->stop_id,
                            terms->hashes_out_id, terms->operator_out_id};
    struct can_filter filters[sizeof ids / sizeof ids[0]];
    unsigned count = 0;
    for (unsigned i = 0; i < sizeof ids / sizeof ids[0]; ++i) {
        if (ids[i] != 0) {
            filters[count].can_id = ids[i];
            filters[count++].can_mask = CAN_EFF_FLAG | CAN_RTR_FLAG | CAN_SFF_MASK;
        }
    }
    const int on = 1;
    if (setsockopt(bus->socket, SOL_CAN_RAW, CAN_RAW_FILTER, filters,
                   (socklen_t)(count * sizeof filters[0])) != 0 ||
        setsockopt(bus->socket, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on) != 0) {
        return fail(bus, fault, fault_bytes, interface, "options");
    }
    struct ifreq request;
    memset(&request, 0, sizeof request);
    strncpy(request.ifr_name, interface, sizeof request.ifr_name - 1);
    if (ioctl(bus->socket, SIOCGIFINDEX, &request) != 0) {
        return fail(bus, fault, fault_bytes, interface, "no such interface");
    }
    struct sockaddr_can address;
    memset(&address, 0, sizeof address);
    address.can_family = AF_CAN;
    address.can_ifindex = request.ifr_ifindex;
    if (bind(bus->socket, (struct sockaddr*)&address, sizeof address) != 0) {
        return fail(bus, fault, fault_bytes, interface, "bind");
    }
    return true;
}

bool axg_bus_send(const axg_bus* bus, const axg_frame* frame) {
    struct canfd_frame raw;
    memset(&raw, 0, sizeof raw);
    const bool is_fd = (frame->flags & AXG_FRAME_FD) != 0;
    raw.can_id = frame->id;
    raw.len = frame->length_bytes;
    raw.flags = (frame->flags & AXG_FRAME_BIT_RATE_SWITCH) != 0 ? CANFD_BRS : 0;
    memcpy(raw.data, frame->data, sizeof raw.data);
    const size_t size = is_fd ? CANFD_MTU : CAN_MTU;
    return send(bus->socket, &raw, size, MSG_DONTWAIT | MSG_NOSIGNAL) == (ssize_t)size;
}

static axg_board_axis_ids ids_of(uint32_t id) {
    const axg_board_axis_ids ids = {id, (uint16_t)id};
    return ids;
}

static void take_status(axg_bus* bus, const axg_frame* frame, int64_t now_us) {
    axg_board_can_frame status;
    memset(&status, 0, sizeof status);
    status.id = frame->id;
    status.length = frame->length_bytes;
    memcpy(status.data, frame->data, sizeof status.data);
    if (axg_operator_decode_status(&status, ids_of(bus->operator_out_id), &bus->status)) {
        bus->has_status = true;
        bus->status_us = now_us;
    }
}

bool axg_bus_receive(axg_bus* bus, int64_t now_us, axg_frame* out) {
    struct canfd_frame raw;
    memset(&raw, 0, sizeof raw);
    ssize_t size = 0;
    while ((size = recv(bus->socket, &raw, sizeof raw, MSG_DONTWAIT)) > 0) {
        if (size != CAN_MTU || raw.len > CAN_MAX_DLEN) {
            continue;  // a guard sends classical frames only
        }
        memset(out, 0, sizeof *out);
        out->time_us = now_us;
        out->id = raw.can_id & CAN_SFF_MASK;
        out->length_bytes = raw.len;
        memcpy(out->data, raw.data, raw.len);
        if (out->id != bus->operator_out_id) {
            return true;
        }
        take_status(bus, out, now_us);
    }
    return false;
}

void axg_bus_press(axg_bus* bus, int64_t now_us) {
    bus->arm_until_us = now_us + PRESSED_US;
    bus->wants_reset = true;
}

static void ask(axg_bus* bus, axg_operator_action action, int64_t now_us) {
    const bool is_asked = bus->status.action == action && bus->status.nonce != 0;
    axg_operator_message message;
    memset(&message, 0, sizeof message);
    message.action = action;
    message.step = is_asked ? AXG_OPERATOR_CONFIRM : AXG_OPERATOR_REQUEST;
    message.counter = bus->counter;
    message.nonce = is_asked ? bus->status.nonce : 0;
    axg_board_can_frame frame;
    axg_operator_encode(&message, ids_of(bus->operator_in_id), &frame);
    axg_frame out;
    memset(&out, 0, sizeof out);
    out.id = frame.id;
    out.length_bytes = frame.length;
    memcpy(out.data, frame.data, sizeof out.data);
    if (axg_bus_send(bus, &out)) {
        bus->counter = (uint8_t)((bus->counter + 1U) & 15U);
        bus->asked_us = now_us;
    }
}

void axg_bus_arm(axg_bus* bus, int64_t now_us) {
    if (bus->arm_until_us == 0 || !bus->has_status || now_us - bus->asked_us < ASK_US) {
        return;
    }
    if (bus->status.phase == AXG_PHASE_ARMED || now_us >= bus->arm_until_us) {
        bus->arm_until_us = 0;
    } else if (bus->status.phase == AXG_PHASE_READY) {
        ask(bus, AXG_OPERATOR_ARM, now_us);
    } else if (bus->status.phase == AXG_PHASE_STOPPED && bus->wants_reset) {
        ask(bus, AXG_OPERATOR_RESET, now_us);
    } else if (bus->status.phase != AXG_PHASE_STOPPED) {
        bus->wants_reset = false;  // one act resets one stop
    }
}

axg_phase axg_bus_phase(const axg_bus* bus, int64_t now_us) {
    const bool is_heard = bus->has_status && now_us - bus->status_us <= HEARD_US &&
                          bus->status.phase <= AXG_PHASE_ARMED;
    return is_heard ? (axg_phase)bus->status.phase : AXG_PHASE_STOPPED;
}

void axg_bus_close(axg_bus* bus) {
    if (bus->socket >= 0) {
        close(bus->socket);
    }
    bus->socket = -1;
}
