#include "enroll/cli/doctor/remedy.h"

#include <stddef.h>

/* clang-format off */
static const char *const remedies[ISO_FAULT_CODES] = {
    [ISO_FAULT_OUT_OF_MEMORY] = "free memory, or use a machine with more; free and systemctl status isothermd show what is used",
    [ISO_FAULT_FILE_MISSING] = "name a file that exists in isotherm.conf(5), or install what is missing",
    [ISO_FAULT_FILE_DENIED] = "let the daemon's user isotherm read the file: chown and chmod; journalctl --unit=isothermd names it",
    [ISO_FAULT_FILE_UNFIT] = "put a regular file of the right kind in its place; links are not followed",
    [ISO_FAULT_DISK_FULL] = "make room on the disk: df shows which one is full",
    [ISO_FAULT_DISK_READ_ONLY] = "find out why the file system is read-only (journalctl --dmesg), then: mount -o remount,rw",
    [ISO_FAULT_DISK_FAILED] = "look what the kernel says of the disk: journalctl --dmesg",
    [ISO_FAULT_MODULE_MISSING] = "install the package that the fault names: apt install isotherm-...",
    [ISO_FAULT_MODULE_UNFIT] = "install all packages of Isotherm from one release",

    [ISO_FAULT_CONFIG_WRONG] = "mend the line in isotherm.conf(5); isothermd --check-config tells whether it is right",
    [ISO_FAULT_OPTION_WRONG] = "mend [sensor] or [door] in isotherm.conf(5); isothermd --check-config tells whether it is right",
    [ISO_FAULT_DRIVER_UNKNOWN] = "that driver is not in this build: mend [sensor] or [door] in isotherm.conf(5), or build with its library",
    [ISO_FAULT_CARDS_WRONG] = "mend the line of the card file that the fault names",
    [ISO_FAULT_MODEL_DAMAGED] = "reinstall the package isotherm-data, or name another file in [model] of isotherm.conf(5)",
    [ISO_FAULT_MODEL_MISFIT] = "use the head model, metric and cohort of one release: [model] in isotherm.conf(5)",

    [ISO_FAULT_SENSOR_MISSING] = "is it plugged in? name a camera that there is in [sensor] of isotherm.conf(5); isothermd --list-devices",
    [ISO_FAULT_SENSOR_GONE] = "check its cable and power; the daemon keeps trying",
    [ISO_FAULT_SENSOR_DENIED] = "install the board's udev rule; the daemon's user has to be in the group of the device: video for /dev/video*",
    [ISO_FAULT_SENSOR_BUSY] = "end the other program that has the camera: fuser -v /dev/video*",
    [ISO_FAULT_SENSOR_UNFIT] = "name a node that takes pictures: v4l2-ctl --list-devices",
    [ISO_FAULT_SENSOR_FORMAT] = "name another node or size: v4l2-ctl --list-formats-ext; a camera has several nodes",
    [ISO_FAULT_SENSOR_SILENT] = "check its cable, power and USB port; the daemon keeps trying",
    [ISO_FAULT_SENSOR_REPEATS] = "the camera is stuck, or is fed with stored pictures: look at it and at its cable, then unplug it and plug it in again",
    [ISO_FAULT_SENSOR_FAILED] = "check its cable and power; the daemon keeps trying; isotherm log",
    [ISO_FAULT_USB_FULL] = "put the cameras on two USB buses, or lower fps in [sensor] of isotherm.conf(5)",
    [ISO_FAULT_CALIBRATION_MISSING] = "calibrate the cameras: isotherm-sim calibrate, and name its file in [sensor] of isotherm.conf(5)",
    [ISO_FAULT_CALIBRATION_WRONG] = "calibrate the cameras anew: isotherm-sim calibrate, or mend the file",
    [ISO_FAULT_CALIBRATION_POOR] = "calibrate the cameras anew with a checkerboard: isotherm-sim calibrate",
    [ISO_FAULT_CALIBRATION_NOMINAL] = "calibrate the cameras with a checkerboard: isotherm-sim calibrate",
    [ISO_FAULT_RECORDING_MISSING] = "let [sensor] path in isotherm.conf(5) name a recording, or choose the driver of a camera",
    [ISO_FAULT_RECORDING_DAMAGED] = "let [sensor] path in isotherm.conf(5) name a whole recording",
    [ISO_FAULT_RECORDING_REPEATS] = "set repeats = no in [sensor] of isotherm.conf(5), unless this is a demonstration",

    [ISO_FAULT_CHIP_MISSING] = "is the board plugged in, its driver loaded? gpiodetect lists chips, isotherm.conf(5) says how lines are named",
    [ISO_FAULT_CHIP_GONE] = "check the cable and power of the GPIO chip; the daemon keeps trying",
    [ISO_FAULT_LINE_MISSING] = "is its chip plugged in? gpioinfo lists the lines and their names; a line without a name is CHIP:OFFSET",
    [ISO_FAULT_LINE_DENIED] = "install the board's udev rule; the daemon's user has to be in the group of /dev/gpiochip*",
    [ISO_FAULT_LINE_BUSY] = "end the other program, or free the line in the board's device tree",
    [ISO_FAULT_LINE_FAILED] = "check its wiring, and [door] in isotherm.conf(5)",

    [ISO_FAULT_KEY_MISSING] = "put the key file back from its copy; see KEYS in isothermd(8)",
    [ISO_FAULT_KEY_WRONG] = "put the key back with which the files were sealed, or the key ring from a backup; see KEYS in isothermd(8)",
    [ISO_FAULT_KEY_EXPOSED] = "chmod 600 the key file, then seal everything with new keys: isotherm key rotate",
    [ISO_FAULT_KEY_RING_OLD] = "put the newest key ring in its place; if it is lost: isothermd --accept-state",
    [ISO_FAULT_KEY_RING_FULL] = "export the people, begin with a new key ring, and import them; see KEYS in isothermd(8)",
    [ISO_FAULT_STORE_BUSY] = "end the other process: fuser -v /var/lib/isotherm/*",
    [ISO_FAULT_STORE_UNSEALED] = "put the sealed file back; to take the one in plain text over once: [seal] migrate = yes in isotherm.conf(5)",
    [ISO_FAULT_STORE_NEWER] = "install the newer version of isothermd",
    [ISO_FAULT_ANCHOR_DAMAGED] = "put the anchor back from a backup; if it is lost: isothermd --accept-state",
    [ISO_FAULT_GALLERY_MISSING] = "put the gallery back from a backup; if it is lost: isothermd --accept-state, and enrol again",
    [ISO_FAULT_GALLERY_DAMAGED] = "put the newest backup in its place; if there is none: move it and its anchor away, isothermd --accept-state, and enrol again",
    [ISO_FAULT_GALLERY_OLD] = "put the newest gallery in its place; if it is lost: isothermd --accept-state",
    [ISO_FAULT_GALLERY_FULL] = "remove people who have left (isotherm remove NAME), or raise [gallery] capacity in isotherm.conf(5)",
    [ISO_FAULT_LOG_DAMAGED] = "put the newest backup in its place; if there is none: move the log and its anchor away, then isothermd --accept-state",
    [ISO_FAULT_LOG_OLD] = "put the newest log with all its segments in its place; if it is lost: isothermd --accept-state",
    [ISO_FAULT_LOG_LATE] = "the disk is too slow or overloaded: iostat shows its load; look what the kernel says: journalctl --dmesg",
    [ISO_FAULT_LOCKOUT_MISSING] = "look at isotherm log for what was locked out, then: isotherm lockdown off",
    [ISO_FAULT_LOCKOUT_DAMAGED] = "look at isotherm log for what was locked out, then: isotherm lockdown off",
    [ISO_FAULT_LOCKOUT_OLD] = "look at isotherm log for what was locked out, then: isotherm lockdown off",

    [ISO_FAULT_CLOCK_UNSET] = "set the clock: timedatectl; until then nobody with time limits is let in",
    [ISO_FAULT_CLOCK_BEHIND] = "set the clock: timedatectl; if it is right, and an earlier date was not: isotherm lockout clear",
    [ISO_FAULT_NOT_CONFINED] = "use a kernel with Landlock and seccomp, and the unit isothermd.service, which sets the limit of locked memory",
    [ISO_FAULT_BUS_MISSING] = "start the bus (systemctl start dbus), or name another with --bus",
    [ISO_FAULT_BUS_REFUSED] = "end the other isothermd, or reinstall the policy of the bus: /usr/share/dbus-1/system.d/org.isotherm.conf",

    [ISO_FAULT_NOT_CONFIGURED] = "isotherm setup",
    [ISO_FAULT_NO_DAEMON] = "systemctl start isothermd; if it does not stay up: journalctl --unit=isothermd",
    [ISO_FAULT_NO_STATUS] = "journalctl --unit=isothermd; systemctl restart isothermd",
    [ISO_FAULT_NOT_PERMITTED] = "become a member of the group isotherm: adduser USER isotherm; then log in anew",
    [ISO_FAULT_VERSION_DIFFERS] = "install both from one release and restart isothermd",
    [ISO_FAULT_LOCKDOWN] = "isotherm log says since when; end it with: isotherm lockdown off",
    [ISO_FAULT_LOCKED_OUT] = "isotherm log says after which visits; end it with: isotherm lockout clear",
    [ISO_FAULT_DOOR_FORCED] = "look at the door, and at isotherm log",
    [ISO_FAULT_DOOR_HELD_OPEN] = "close the door",
    [ISO_FAULT_DOOR_AT_FAULT] = "mend the fault of its lines or of the sensor, see there; isotherm log",
    [ISO_FAULT_DOOR_UNWIRED] = "set [door] backend and its lines in isotherm.conf(5)",
    [ISO_FAULT_MODEL_ABSENT] = "reinstall head.model, or mend [model] in isotherm.conf(5)",
    [ISO_FAULT_IMAGE_CHECK_ABSENT] = "install the package isotherm-vision, or set intensity = off in [recognition] of isotherm.conf(5)",
    [ISO_FAULT_GALLERY_EMPTY] = "the door opens to nobody yet: isotherm enroll NAME",
    [ISO_FAULT_NOBODY_VALID] = "isotherm list shows from when and until when each may come in; isotherm validity NAME changes it; is the clock right?",
    [ISO_FAULT_TEMPLATES_OLD] = "enrol these people again: isotherm list shows who has no usable template",
};
/* clang-format on */

const char *cli_remedy(enum iso_fault_code code)
{
    return (unsigned)code < ISO_FAULT_CODES ? remedies[code] : NULL;
}
