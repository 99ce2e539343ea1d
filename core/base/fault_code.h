/* Fault codes. A fault has a sentence for people and, nearly always, a code for programs
 * (ISO_FAULT_NONE: only the sentence). `isotherm doctor` finds the remedy of a fault by its code.
 *
 * This file lists all codes of the project. It is in core because core, drivers, firmware and
 * enroll may all include core/base; core itself does not use the codes of devices and stores. The
 * names of the codes are a part of the bus interface (firmware/contract/contract.h), so a published
 * name never changes, and its meaning never changes. The numbers are not published and may change.
 *
 * A new code needs four things: a row in fault_code.c with its name and meaning, a row in
 * enroll/cli/doctor/remedy.c, an entry in the section FAULTS of isothermd(8), and code that reports
 * it. tests/enroll/test_manual.c checks the manual, tests/enroll/test_fault_code.c the others. */
#ifndef ISO_CORE_BASE_FAULT_CODE_H
#define ISO_CORE_BASE_FAULT_CODE_H

#include <stdbool.h>

enum iso_fault_code {
    ISO_FAULT_NONE, /* the fault has a sentence and no code */

    /* Files and memory. */
    ISO_FAULT_OUT_OF_MEMORY,
    ISO_FAULT_FILE_MISSING,
    ISO_FAULT_FILE_DENIED,
    ISO_FAULT_FILE_UNFIT,
    ISO_FAULT_DISK_FULL,
    ISO_FAULT_DISK_READ_ONLY,
    ISO_FAULT_DISK_FAILED,
    ISO_FAULT_MODULE_MISSING,
    ISO_FAULT_MODULE_UNFIT,

    /* Configuration and data files. */
    ISO_FAULT_CONFIG_WRONG,
    ISO_FAULT_OPTION_WRONG,
    ISO_FAULT_DRIVER_UNKNOWN,
    ISO_FAULT_CARDS_WRONG,
    ISO_FAULT_MODEL_DAMAGED,
    ISO_FAULT_MODEL_MISFIT,

    /* The sensor. */
    ISO_FAULT_SENSOR_MISSING,
    ISO_FAULT_SENSOR_GONE,
    ISO_FAULT_SENSOR_DENIED,
    ISO_FAULT_SENSOR_BUSY,
    ISO_FAULT_SENSOR_UNFIT,
    ISO_FAULT_SENSOR_FORMAT,
    ISO_FAULT_SENSOR_SILENT,
    ISO_FAULT_SENSOR_REPEATS,
    ISO_FAULT_SENSOR_FAILED,
    ISO_FAULT_USB_FULL,
    ISO_FAULT_CALIBRATION_MISSING,
    ISO_FAULT_CALIBRATION_WRONG,
    ISO_FAULT_CALIBRATION_POOR,
    ISO_FAULT_CALIBRATION_NOMINAL,
    ISO_FAULT_RECORDING_MISSING,
    ISO_FAULT_RECORDING_DAMAGED,
    ISO_FAULT_RECORDING_REPEATS,

    /* The door's lines. */
    ISO_FAULT_CHIP_MISSING,
    ISO_FAULT_CHIP_GONE,
    ISO_FAULT_LINE_MISSING,
    ISO_FAULT_LINE_DENIED,
    ISO_FAULT_LINE_BUSY,
    ISO_FAULT_LINE_FAILED,

    /* The bus of an access panel. */
    ISO_FAULT_PANEL_LINE,
    ISO_FAULT_PANEL_SILENT,
    ISO_FAULT_PANEL_KEY,

    /* Keys and stores. */
    ISO_FAULT_KEY_MISSING,
    ISO_FAULT_KEY_WRONG,
    ISO_FAULT_KEY_EXPOSED,
    ISO_FAULT_KEY_RING_OLD,
    ISO_FAULT_KEY_RING_FULL,
    ISO_FAULT_STORE_BUSY,
    ISO_FAULT_STORE_UNSEALED,
    ISO_FAULT_STORE_NEWER,
    ISO_FAULT_ANCHOR_DAMAGED,
    ISO_FAULT_GALLERY_MISSING,
    ISO_FAULT_GALLERY_DAMAGED,
    ISO_FAULT_GALLERY_OLD,
    ISO_FAULT_GALLERY_FULL,
    ISO_FAULT_LOG_DAMAGED,
    ISO_FAULT_LOG_OLD,
    ISO_FAULT_LOG_LATE,
    ISO_FAULT_LOCKOUT_MISSING,
    ISO_FAULT_LOCKOUT_DAMAGED,
    ISO_FAULT_LOCKOUT_OLD,
    ISO_FAULT_LOCKOUT_UNREADABLE,
    ISO_FAULT_STATE_OLD,
    ISO_FAULT_COUNTER_GONE,
    ISO_FAULT_COUNTER_OTHER,
    ISO_FAULT_COUNTER_UNFIT,
    ISO_FAULT_TPM_MISSING,
    ISO_FAULT_TPM_DENIED,
    ISO_FAULT_TPM_FAILED,

    /* The machine. */
    ISO_FAULT_CLOCK_UNSET,
    ISO_FAULT_CLOCK_BEHIND,
    ISO_FAULT_NOT_CONFINED,
    ISO_FAULT_NOT_REALTIME,
    ISO_FAULT_TIME_SHORT,
    ISO_FAULT_BUS_MISSING,
    ISO_FAULT_BUS_REFUSED,

    /* The state of the daemon and of the door, as a client sees it. */
    ISO_FAULT_NOT_CONFIGURED,
    ISO_FAULT_NO_DAEMON,
    ISO_FAULT_NO_STATUS,
    ISO_FAULT_NOT_PERMITTED,
    ISO_FAULT_VERSION_DIFFERS,
    ISO_FAULT_LOCKDOWN,
    ISO_FAULT_LOCKED_OUT,
    ISO_FAULT_DOOR_FORCED,
    ISO_FAULT_DOOR_HELD_OPEN,
    ISO_FAULT_DOOR_AT_FAULT,
    ISO_FAULT_DOOR_UNWIRED,
    ISO_FAULT_MODEL_ABSENT,
    ISO_FAULT_IMAGE_CHECK_ABSENT,
    ISO_FAULT_GALLERY_EMPTY,
    ISO_FAULT_NOBODY_VALID,
    ISO_FAULT_TEMPLATES_OLD,
    ISO_FAULT_SITE_PROVISIONAL,

    ISO_FAULT_CODES /* how many there are */
};

/* The name of a code, words of a to z with hyphens, such as "disk-full"; "none" for ISO_FAULT_NONE;
 * NULL outside the range. A constant. */
const char *iso_fault_code_name(enum iso_fault_code code);

/* What the code means, in one sentence for people; NULL outside the range. A constant. */
const char *iso_fault_code_meaning(enum iso_fault_code code);

/* Finds the code of a name. Returns false, and leaves *out as it was, if there is no such name. */
bool iso_fault_code_find(const char *name, enum iso_fault_code *out);

#endif
