/* The serial line of an RS-485 bus: raw bytes, 8 data bits, no parity, one stop bit. */
#ifndef ISO_DRIVERS_DOOR_OSDP_OSDP_SERIAL_H
#define ISO_DRIVERS_DOOR_OSDP_OSDP_SERIAL_H

#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"

/* Opens a line for this program alone, without waiting for a carrier, with O_NONBLOCK. If its
 * driver can switch the direction of an RS-485 transceiver, it is told to do so; the settings of
 * the board's device tree are kept. A driver that cannot (ENOTTY) is accepted, because most USB
 * adapters switch by themselves. The caller closes *fd.
 *
 * -ENODEV there is no such line; -EACCES; -EBUSY another program uses it; -EINVAL it is no serial
 * line, or does not have this speed; or another errno. The code is PANEL_LINE. */
int iso_osdp_serial_open(const char *path, uint32_t baud, int *fd, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Changes the speed, after all bytes have been sent. 0 or a negative errno. */
int iso_osdp_serial_set_baud(int fd, uint32_t baud) __attribute__((warn_unused_result));

/* Writes all bytes, however small the driver's buffer is. -EIO the line is gone, or its driver has
 * taken no byte for 200 ms. */
int iso_osdp_serial_write(int fd, const uint8_t *bytes, size_t n)
    __attribute__((warn_unused_result));

#endif
