#include "drivers/door/osdp/osdp_serial.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/serial.h>
#include <poll.h>
#include <string.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

static speed_t speed_of(uint32_t baud)
{
    switch (baud) {
    case 9600:
        return B9600;
    case 19200:
        return B19200;
    case 38400:
        return B38400;
    case 57600:
        return B57600;
    case 115200:
        return B115200;
    default:
        return B0;
    }
}

static int configure(int fd, uint32_t baud, int when)
{
    struct termios line;
    const speed_t speed = speed_of(baud);
    if (speed == B0) {
        return -EINVAL;
    }
    if (tcgetattr(fd, &line)) {
        return -errno;
    }
    cfmakeraw(&line);
    line.c_cflag &= (tcflag_t) ~(CSTOPB | CRTSCTS | PARENB);
    line.c_cflag |= CS8 | CREAD | CLOCAL;
    line.c_cc[VMIN] = 1;
    line.c_cc[VTIME] = 0;
    if (cfsetspeed(&line, speed) || tcsetattr(fd, when, &line)) {
        return -errno;
    }
    /* tcsetattr succeeds if anything at all could be set. */
    struct termios now;
    if (tcgetattr(fd, &now)) {
        return -errno;
    }
    return cfgetospeed(&now) == speed ? 0 : -EINVAL;
}

/* Lets the driver switch the transceiver to sending and back. */
static int use_rs485(int fd)
{
    struct serial_rs485 mode;
    memset(&mode, 0, sizeof mode);
    if (ioctl(fd, TIOCGRS485, &mode)) {
        return errno == ENOTTY || errno == EINVAL ? 0 : -errno;
    }
    if (mode.flags & SER_RS485_ENABLED) {
        return 0;
    }
    mode.flags |= SER_RS485_ENABLED;
    if (!(mode.flags & (SER_RS485_RTS_ON_SEND | SER_RS485_RTS_AFTER_SEND))) {
        mode.flags |= SER_RS485_RTS_ON_SEND;
    }
    /* Some drivers can tell their mode and cannot change it. */
    return ioctl(fd, TIOCSRS485, &mode) && errno != ENOTTY && errno != EINVAL ? -errno : 0;
}

static int refuse(const char *path, int error, struct iso_fault *fault)
{
    const bool missing = error == -ENOENT || error == -ENXIO;
    return iso_fault_set_code(
        fault, ISO_FAULT_PANEL_LINE, missing ? -ENODEV : error, "osdp: %s: %s", path,
        error == -EBUSY ? "another program uses this line" : strerror(-error));
}

int iso_osdp_serial_open(const char *path, uint32_t baud, int *fd, struct iso_fault *fault)
{
    const int line = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (line < 0) {
        return refuse(path, -errno, fault);
    }
    int error = 0;
    if (!isatty(line)) {
        error = iso_fault_set_code(fault, ISO_FAULT_PANEL_LINE, -EINVAL,
                                   "osdp: %s is not a serial line", path);
    } else if (flock(line, LOCK_EX | LOCK_NB)) {
        /* TIOCEXCL does not keep out a program of root; the lock keeps out a second daemon. */
        error = refuse(path, errno == EWOULDBLOCK ? -EBUSY : -errno, fault);
    } else if (ioctl(line, TIOCEXCL)) {
        error = refuse(path, -errno, fault);
    } else {
        error = configure(line, baud, TCSANOW);
        error = error ? error : use_rs485(line);
        if (error) {
            (void)refuse(path, error, fault);
        }
    }
    if (error) {
        (void)close(line);
        return error;
    }
    (void)tcflush(line, TCIOFLUSH);
    *fd = line;
    return 0;
}

int iso_osdp_serial_set_baud(int fd, uint32_t baud)
{
    return configure(fd, baud, TCSADRAIN);
}

int iso_osdp_serial_write(int fd, const uint8_t *bytes, size_t n)
{
    enum { WAIT_MS = 200 };
    while (n > 0) {
        const ssize_t written = write(fd, bytes, n);
        if (written > 0) {
            bytes += written;
            n -= (size_t)written;
        } else if (written < 0 && errno == EAGAIN) {
            struct pollfd wait = {.fd = fd, .events = POLLOUT};
            if (poll(&wait, 1, WAIT_MS) <= 0) {
                return -EIO;
            }
        } else if (errno != EINTR) {
            return -EIO;
        }
    }
    return 0;
}
