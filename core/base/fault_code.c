#include "core/base/fault_code.h"

#include <stddef.h>
#include <string.h>

/* clang-format off */
static const struct {
    const char *name, *meaning;
} codes[ISO_FAULT_CODES] = {
    [ISO_FAULT_NONE] = {"none", "The fault has no code; its sentence says everything that is known."},

    [ISO_FAULT_OUT_OF_MEMORY] = {"out-of-memory", "The program got no memory."},
    [ISO_FAULT_FILE_MISSING] = {"file-missing", "A file that is named does not exist."},
    [ISO_FAULT_FILE_DENIED] = {"file-denied", "The program may not open a file."},
    [ISO_FAULT_FILE_UNFIT] = {"file-unfit", "A name belongs to a directory, link or device, or the file is too large."},
    [ISO_FAULT_DISK_FULL] = {"disk-full", "A disk, a quota or a limit has no room left."},
    [ISO_FAULT_DISK_READ_ONLY] = {"disk-read-only", "A file system cannot be written."},
    [ISO_FAULT_DISK_FAILED] = {"disk-failed", "A disk reported an error."},
    [ISO_FAULT_MODULE_MISSING] = {"module-missing", "A package with a driver or a check is not installed."},
    [ISO_FAULT_MODULE_UNFIT] = {"module-unfit", "A module is of another version or cannot be loaded."},

    [ISO_FAULT_CONFIG_WRONG] = {"config-wrong", "A line of the configuration is wrong."},
    [ISO_FAULT_OPTION_WRONG] = {"option-wrong", "A setting of the sensor or the door is missing or wrong."},
    [ISO_FAULT_DRIVER_UNKNOWN] = {"driver-unknown", "This build has no driver of that name."},
    [ISO_FAULT_CARDS_WRONG] = {"cards-wrong", "The file of card numbers cannot be used."},
    [ISO_FAULT_MODEL_DAMAGED] = {"model-damaged", "A model file is damaged."},
    [ISO_FAULT_MODEL_MISFIT] = {"model-misfit", "The metric or cohort was made with another head model or other options."},

    [ISO_FAULT_SENSOR_MISSING] = {"sensor-missing", "The camera that is named is not there."},
    [ISO_FAULT_SENSOR_GONE] = {"sensor-gone", "The camera disappeared while it was in use."},
    [ISO_FAULT_SENSOR_DENIED] = {"sensor-denied", "The daemon may not open the camera."},
    [ISO_FAULT_SENSOR_BUSY] = {"sensor-busy", "Another program uses the camera."},
    [ISO_FAULT_SENSOR_UNFIT] = {"sensor-unfit", "The device is not a camera that delivers pictures."},
    [ISO_FAULT_SENSOR_FORMAT] = {"sensor-format", "The camera does not offer the format or size that is needed."},
    [ISO_FAULT_SENSOR_SILENT] = {"sensor-silent", "The camera runs, but delivers nothing."},
    [ISO_FAULT_SENSOR_REPEATS] = {"sensor-repeats", "The camera delivers frames that it delivered before."},
    [ISO_FAULT_SENSOR_FAILED] = {"sensor-failed", "The stream of the camera broke, or a picture came damaged."},
    [ISO_FAULT_USB_FULL] = {"usb-full", "The USB bus has no bandwidth left for the camera."},
    [ISO_FAULT_CALIBRATION_MISSING] = {"calibration-missing", "The cameras have no calibration."},
    [ISO_FAULT_CALIBRATION_WRONG] = {"calibration-wrong", "The calibration or camera file is damaged, or is for another size."},
    [ISO_FAULT_CALIBRATION_POOR] = {"calibration-poor", "The calibration is more than half a pixel off."},
    [ISO_FAULT_CALIBRATION_NOMINAL] = {"calibration-nominal", "The calibration was not measured on this camera."},
    [ISO_FAULT_RECORDING_MISSING] = {"recording-missing", "There is no recording at the path to be replayed."},
    [ISO_FAULT_RECORDING_DAMAGED] = {"recording-damaged", "The recording cannot be read."},
    [ISO_FAULT_RECORDING_REPEATS] = {"recording-repeats", "Stored frames may count more than once."},

    [ISO_FAULT_CHIP_MISSING] = {"chip-missing", "The GPIO chip that is named is not there."},
    [ISO_FAULT_CHIP_GONE] = {"chip-gone", "The GPIO chip disappeared while it was in use."},
    [ISO_FAULT_LINE_MISSING] = {"line-missing", "No GPIO chip has the line that is named."},
    [ISO_FAULT_LINE_DENIED] = {"line-denied", "The daemon may not open a GPIO chip."},
    [ISO_FAULT_LINE_BUSY] = {"line-busy", "Another program or driver uses a line of the door."},
    [ISO_FAULT_LINE_FAILED] = {"line-failed", "A line of the door cannot be read or switched."},

    [ISO_FAULT_PANEL_LINE] = {"panel-line", "The serial line to the access panel cannot be used."},
    [ISO_FAULT_PANEL_SILENT] = {"panel-silent", "The access panel sends nothing."},
    [ISO_FAULT_PANEL_KEY] = {"panel-key", "The stored key of the access panel cannot be used."},

    [ISO_FAULT_KEY_MISSING] = {"key-missing", "The key file is gone."},
    [ISO_FAULT_KEY_WRONG] = {"key-wrong", "The key is not the one with which the files were sealed, or the key ring is damaged."},
    [ISO_FAULT_KEY_EXPOSED] = {"key-exposed", "Other users can read the key file."},
    [ISO_FAULT_KEY_RING_OLD] = {"key-ring-old", "The key ring is from an earlier time than the other stores."},
    [ISO_FAULT_KEY_RING_FULL] = {"key-ring-full", "The key ring has no room for another key."},
    [ISO_FAULT_STORE_BUSY] = {"store-busy", "Another process uses the gallery or the log."},
    [ISO_FAULT_STORE_UNSEALED] = {"store-unsealed", "A gallery or a log in plain text lies where a sealed one is expected."},
    [ISO_FAULT_STORE_NEWER] = {"store-newer", "The gallery was written by a newer version."},
    [ISO_FAULT_ANCHOR_DAMAGED] = {"anchor-damaged", "The anchor of the gallery or the log is damaged or gone."},
    [ISO_FAULT_GALLERY_MISSING] = {"gallery-missing", "The gallery is gone, and other files know that there was one."},
    [ISO_FAULT_GALLERY_DAMAGED] = {"gallery-damaged", "The gallery is damaged, or is not a gallery."},
    [ISO_FAULT_GALLERY_OLD] = {"gallery-old", "The gallery is from an earlier time than the other stores."},
    [ISO_FAULT_GALLERY_FULL] = {"gallery-full", "The gallery has no room for another person or template."},
    [ISO_FAULT_LOG_DAMAGED] = {"log-damaged", "A record of the log is damaged."},
    [ISO_FAULT_LOG_OLD] = {"log-old", "The log is from an earlier time, or a part of it is missing."},
    [ISO_FAULT_LOG_LATE] = {"log-late", "A record did not get to the disk in time."},
    [ISO_FAULT_LOCKOUT_MISSING] = {"lockout-missing", "The lock-out file is gone, and other files know that there was one."},
    [ISO_FAULT_LOCKOUT_DAMAGED] = {"lockout-damaged", "The lock-out file is damaged."},
    [ISO_FAULT_LOCKOUT_OLD] = {"lockout-old", "The lock-out file is from an earlier time than the other stores."},
    [ISO_FAULT_LOCKOUT_UNREADABLE] = {"lockout-unreadable", "The lock-out file cannot be read from the disk."},
    [ISO_FAULT_STATE_OLD] = {"state-old", "The state directory is from an earlier time than the counter in the TPM."},
    [ISO_FAULT_COUNTER_GONE] = {"counter-gone", "The counter of the state directory does not exist in the TPM."},
    [ISO_FAULT_COUNTER_OTHER] = {"counter-other", "The state directory belongs to another counter than that of this TPM."},
    [ISO_FAULT_COUNTER_UNFIT] = {"counter-unfit", "The index of the counter in the TPM holds something else, or a value that is too large."},
    [ISO_FAULT_TPM_MISSING] = {"tpm-missing", "There is no TPM at the place that is named."},
    [ISO_FAULT_TPM_DENIED] = {"tpm-denied", "The daemon may not use the TPM, or its owner has a password."},
    [ISO_FAULT_TPM_FAILED] = {"tpm-failed", "The TPM does not answer, or reports an error."},

    [ISO_FAULT_CLOCK_UNSET] = {"clock-unset", "The clock is not set."},
    [ISO_FAULT_CLOCK_BEHIND] = {"clock-behind", "The clock was set back behind the newest record of the log."},
    [ISO_FAULT_NOT_CONFINED] = {"not-confined", "The kernel does not protect the daemon's memory, files or system calls."},
    [ISO_FAULT_NOT_REALTIME] = {"not-realtime", "The thread of the door has no real-time priority, and the door may be late on a busy machine."},
    [ISO_FAULT_TIME_SHORT] = {"time-short", "A grant has hardly enough time before it is stale."},
    [ISO_FAULT_BUS_MISSING] = {"bus-missing", "The message bus cannot be reached."},
    [ISO_FAULT_BUS_REFUSED] = {"bus-refused", "The message bus did not give the daemon its name."},

    [ISO_FAULT_NOT_CONFIGURED] = {"not-configured", "The appliance has no configuration yet."},
    [ISO_FAULT_NO_DAEMON] = {"no-daemon", "isothermd is not running on this bus."},
    [ISO_FAULT_NO_STATUS] = {"no-status", "The daemon does not report its status, or a part of it."},
    [ISO_FAULT_NOT_PERMITTED] = {"not-permitted", "This user may not command the daemon."},
    [ISO_FAULT_VERSION_DIFFERS] = {"version-differs", "The daemon and the client are of different versions."},
    [ISO_FAULT_LOCKDOWN] = {"lockdown", "The door is under lockdown and lets nobody in."},
    [ISO_FAULT_LOCKED_OUT] = {"locked-out", "The door lets nobody in for a while, after too many failures."},
    [ISO_FAULT_DOOR_FORCED] = {"door-forced", "The door was opened while it was locked."},
    [ISO_FAULT_DOOR_HELD_OPEN] = {"door-held-open", "The door stands open too long."},
    [ISO_FAULT_DOOR_AT_FAULT] = {"door-at-fault", "The door is in its safe state, because its lines or the sensor do not work."},
    [ISO_FAULT_DOOR_UNWIRED] = {"door-unwired", "The door has the back end null, which switches nothing."},
    [ISO_FAULT_MODEL_ABSENT] = {"model-absent", "The daemon has no head model."},
    [ISO_FAULT_IMAGE_CHECK_ABSENT] = {"image-check-absent", "The check of camera images for faces is not installed."},
    [ISO_FAULT_GALLERY_EMPTY] = {"gallery-empty", "Nobody is enrolled."},
    [ISO_FAULT_NOBODY_VALID] = {"nobody-valid", "People are enrolled, but none of them may come in at this time."},
    [ISO_FAULT_TEMPLATES_OLD] = {"templates-old", "Some people have only templates of another algorithm."},
    [ISO_FAULT_SITE_PROVISIONAL] = {"site-provisional", "The metric has not adapted to the people yet."},
};
/* clang-format on */

const char *iso_fault_code_name(enum iso_fault_code code)
{
    return (unsigned)code < ISO_FAULT_CODES ? codes[code].name : NULL;
}

const char *iso_fault_code_meaning(enum iso_fault_code code)
{
    return (unsigned)code < ISO_FAULT_CODES ? codes[code].meaning : NULL;
}

bool iso_fault_code_find(const char *name, enum iso_fault_code *out)
{
    for (unsigned i = 0; i < ISO_FAULT_CODES; i++) {
        if (strcmp(codes[i].name, name) == 0) {
            *out = (enum iso_fault_code)i;
            return true;
        }
    }
    return false;
}
