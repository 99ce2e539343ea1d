#include "tests/vm/usb/usbip.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#define HOST "/sys/devices/platform/vhci_hcd.0"

enum { CMD_SUBMIT = 1, CMD_UNLINK, RET_SUBMIT, RET_UNLINK };
enum { HIGH_SPEED = 3, PORT_FREE = 4 }; /* enum usb_device_speed; enum usbip_device_status */
enum { URBS_MAX = 16, TRANSFER_MAX = 65536, HEADER_WORDS = 12 };

/* A transfer that waits for data. */
struct urb {
    uint32_t number;
    size_t room;
};

struct usbip_cable {
    struct usbip_device device;
    unsigned port;
    int fd, wake_fd;
    pthread_t thread;
    size_t n_urbs[USBIP_ENDPOINTS];
    struct urb urbs[USBIP_ENDPOINTS][URBS_MAX]; /* the oldest is first */
    uint8_t data[TRANSFER_MAX];
};

/* The header of each transfer, in host byte order. */
struct header {
    uint32_t command, number, device, inwards, endpoint;
    uint32_t words[5]; /* SUBMIT: flags, length, ...; UNLINK: number; RET_*: status, length, ... */
    uint8_t setup[8];
};

/* ---- the wire --------------------------------------------------------------- */

static bool receive(const struct usbip_cable *cable, void *bytes, size_t n)
{
    return n == 0 || recv(cable->fd, bytes, n, MSG_WAITALL) == (ssize_t)n;
}

static bool receive_header(const struct usbip_cable *cable, struct header *out)
{
    uint32_t raw[HEADER_WORDS];
    uint32_t *words = &out->command;
    if (!receive(cable, raw, sizeof raw)) {
        return false;
    }
    for (int i = 0; i < 5; i++) {
        words[i] = ntohl(raw[i]);
        out->words[i] = ntohl(raw[5 + i]);
    }
    memcpy(out->setup, raw + 10, sizeof out->setup);
    return true;
}

static bool answer(const struct usbip_cable *cable, uint32_t command, uint32_t number, int status,
                   const void *data, size_t n, size_t length)
{
    const uint32_t raw[HEADER_WORDS] = {htonl(command),          htonl(number),          0, 0, 0,
                                        htonl((uint32_t)status), htonl((uint32_t)length)};
    return send(cable->fd, raw, sizeof raw, MSG_NOSIGNAL) == (ssize_t)sizeof raw &&
           (n == 0 || send(cable->fd, data, n, MSG_NOSIGNAL) == (ssize_t)n);
}

/* ---- transfers -------------------------------------------------------------- */

static bool do_control(struct usbip_cable *cable, const struct header *header)
{
    const uint8_t *s = header->setup;
    const struct usbip_setup setup = {.type = s[0],
                                      .request = s[1],
                                      .value = (uint16_t)(s[2] | s[3] << 8),
                                      .index = (uint16_t)(s[4] | s[5] << 8),
                                      .length = (uint16_t)(s[6] | s[7] << 8)};
    int n = cable->device.control(cable->device.self, &setup, cable->data);
    if (n < 0) {
        return answer(cable, RET_SUBMIT, header->number, n, NULL, 0, 0);
    }
    if (!header->inwards) {
        return answer(cable, RET_SUBMIT, header->number, 0, NULL, 0, header->words[1]);
    }
    size_t length = (size_t)n < header->words[1] ? (size_t)n : header->words[1];
    return answer(cable, RET_SUBMIT, header->number, 0, cable->data, length, length);
}

static bool submit(struct usbip_cable *cable, const struct header *header)
{
    const size_t length = header->words[1];
    if (length > sizeof cable->data || (!header->inwards && !receive(cable, cable->data, length))) {
        return false;
    }
    if (header->endpoint == 0) {
        return do_control(cable, header);
    }
    const unsigned index = header->endpoint - 1;
    if (!header->inwards || index >= USBIP_ENDPOINTS || cable->n_urbs[index] == URBS_MAX) {
        return answer(cable, RET_SUBMIT, header->number, -EPIPE, NULL, 0, 0);
    }
    cable->urbs[index][cable->n_urbs[index]++] = (struct urb){header->number, length};
    return true;
}

static void forget_urb(struct usbip_cable *cable, unsigned index, size_t at)
{
    const size_t behind = --cable->n_urbs[index] - at;
    memmove(&cable->urbs[index][at], &cable->urbs[index][at + 1], behind * sizeof(struct urb));
}

static bool unlink_urb(struct usbip_cable *cable, const struct header *header)
{
    int status = 0; /* the transfer was already answered */
    for (unsigned i = 0; i < USBIP_ENDPOINTS; i++) {
        for (size_t k = 0; k < cable->n_urbs[i]; k++) {
            if (cable->urbs[i][k].number == header->words[0]) {
                forget_urb(cable, i, k);
                status = -ECONNRESET;
                break;
            }
        }
    }
    return answer(cable, RET_UNLINK, header->number, status, NULL, 0, 0);
}

/* Fills the waiting transfers as far as the device has data. */
static bool fill(struct usbip_cable *cable)
{
    for (unsigned i = 0; i < USBIP_ENDPOINTS; i++) {
        while (cable->n_urbs[i] > 0) {
            const struct urb urb = cable->urbs[i][0];
            const int n = cable->device.fill(cable->device.self, i + 1, cable->data, urb.room);
            if (n == -EAGAIN) {
                break;
            }
            const size_t length = n < 0 ? 0 : (size_t)n;
            forget_urb(cable, i, 0);
            if (!answer(cable, RET_SUBMIT, urb.number, n < 0 ? n : 0, cable->data, length,
                        length)) {
                return false;
            }
        }
    }
    return true;
}

static void *serve(void *context)
{
    struct usbip_cable *cable = context;
    struct pollfd fds[] = {{.fd = cable->fd, .events = POLLIN},
                           {.fd = cable->wake_fd, .events = POLLIN}};
    bool good = true;
    while (good && poll(fds, 2, -1) > 0) {
        struct header header;
        uint64_t times;
        if (fds[1].revents) {
            (void)!read(cable->wake_fd, &times, sizeof times);
        }
        if (fds[0].revents) {
            good = receive_header(cable, &header) &&
                   (header.command == CMD_SUBMIT ? submit(cable, &header)
                                                 : unlink_urb(cable, &header));
        }
        good = good && fill(cable);
    }
    return NULL;
}

void usbip_wake(struct usbip_cable *cable)
{
    const uint64_t one = 1;
    (void)!write(cable->wake_fd, &one, sizeof one);
}

/* ---- the port --------------------------------------------------------------- */

static int command(const char *path, const char *text, struct iso_fault *fault)
{
    const int fd = open(path, O_WRONLY | O_CLOEXEC);
    int error = fd < 0 || write(fd, text, strlen(text)) < 0 ? -errno : 0;
    if (fd >= 0) {
        (void)close(fd);
    }
    return error ? iso_fault_set(fault, error, "%s: '%s': %s", path, text, strerror(-error)) : 0;
}

static bool is_free(unsigned port)
{
    char line[128];
    unsigned number, status;
    bool found = false;
    FILE *file = fopen(HOST "/status", "re");
    while (file && fgets(line, sizeof line, file)) {
        if (sscanf(line, "%*s %u %u", &number, &status) == 2 && number == port) {
            found = status == PORT_FREE;
        }
    }
    if (file) {
        (void)fclose(file);
    }
    return found;
}

static int attach(struct usbip_cable *cable, int kernel_fd, struct iso_fault *fault)
{
    char text[64];
    (void)snprintf(text, sizeof text, "%u %d %u %d", cable->port, kernel_fd, cable->port + 1,
                   HIGH_SPEED);
    int error = pthread_create(&cable->thread, NULL, serve, cable);
    if (error) {
        return iso_fault_set(fault, -error, "usbip: no thread: %s", strerror(error));
    }
    error = command(HOST "/attach", text, fault);
    if (error) {
        (void)shutdown(cable->fd, SHUT_RDWR);
        (void)pthread_join(cable->thread, NULL);
    }
    return error;
}

static void release(struct usbip_cable *cable)
{
    (void)close(cable->fd);
    (void)close(cable->wake_fd);
    free(cable);
}

int usbip_plug_in(const struct usbip_device *device, unsigned port, struct usbip_cable **out,
                  struct iso_fault *fault)
{
    int fds[2];
    struct usbip_cable *cable = calloc(1, sizeof *cable);
    if (!cable || socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, fds)) {
        free(cable);
        return iso_fault_set(fault, -ENOMEM, "usbip: no cable: %m");
    }
    cable->device = *device;
    cable->port = port;
    cable->fd = fds[0];
    cable->wake_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    const int error = attach(cable, fds[1], fault);
    (void)close(fds[1]); /* the kernel has its own reference */
    if (error) {
        release(cable);
        return error;
    }
    *out = cable;
    return 0;
}

void usbip_pull_out(struct usbip_cable *cable)
{
    char text[16];
    if (!cable) {
        return;
    }
    (void)snprintf(text, sizeof text, "%u", cable->port);
    (void)command(HOST "/detach", text, NULL);
    (void)pthread_join(cable->thread, NULL);
    /* The kernel gives no notice when the port is free, so ask until it is. */
    for (int i = 0; i < 1000 && !is_free(cable->port); i++) {
        (void)poll(NULL, 0, 10);
    }
    release(cable);
}
