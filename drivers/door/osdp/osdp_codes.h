/* Numbers of the Open Supervised Device Protocol (IEC 60839-11-5, SIA OSDP 2.2): codes of commands,
 * replies, refusals and security blocks, and the colours of a lamp. */
#ifndef ISO_DRIVERS_DOOR_OSDP_OSDP_CODES_H
#define ISO_DRIVERS_DOOR_OSDP_OSDP_CODES_H

enum iso_osdp_command {
    ISO_OSDP_POLL = 0x60,
    ISO_OSDP_ID = 0x61,
    ISO_OSDP_CAP = 0x62,
    ISO_OSDP_LSTAT = 0x64,
    ISO_OSDP_ISTAT = 0x65,
    ISO_OSDP_OSTAT = 0x66,
    ISO_OSDP_RSTAT = 0x67,
    ISO_OSDP_OUT = 0x68,
    ISO_OSDP_LED = 0x69,
    ISO_OSDP_BUZ = 0x6A,
    ISO_OSDP_TEXT = 0x6B,
    ISO_OSDP_COMSET = 0x6E,
    ISO_OSDP_KEYSET = 0x75,
    ISO_OSDP_CHLNG = 0x76,
    ISO_OSDP_SCRYPT = 0x77,
};

enum iso_osdp_reply {
    ISO_OSDP_ACK = 0x40,
    ISO_OSDP_NAK = 0x41,
    ISO_OSDP_PDID = 0x45,
    ISO_OSDP_PDCAP = 0x46,
    ISO_OSDP_LSTATR = 0x48,
    ISO_OSDP_ISTATR = 0x49,
    ISO_OSDP_OSTATR = 0x4A,
    ISO_OSDP_RSTATR = 0x4B,
    ISO_OSDP_RAW = 0x50,
    ISO_OSDP_FMT = 0x51,
    ISO_OSDP_KEYPAD = 0x53,
    ISO_OSDP_COM = 0x54,
    ISO_OSDP_CCRYPT = 0x76,
    ISO_OSDP_RMAC_I = 0x78,
    ISO_OSDP_BUSY = 0x79,
};

/* The reason in a NAK. */
enum iso_osdp_nak {
    ISO_OSDP_NAK_LENGTH = 0x02,    /* the command has too few or too many bytes */
    ISO_OSDP_NAK_COMMAND = 0x03,   /* the command is unknown or not supported */
    ISO_OSDP_NAK_SEQUENCE = 0x04,  /* neither the next sequence number nor a repeated frame */
    ISO_OSDP_NAK_BLOCK = 0x05,     /* no such security block, or its key may not be used */
    ISO_OSDP_NAK_UNSECURED = 0x06, /* the command is accepted in a secure channel only */
    ISO_OSDP_NAK_RECORD = 0x09,    /* the command cannot be done with these values */
};

/* The type of a security block. */
enum iso_osdp_block {
    ISO_OSDP_SCS_NONE = 0,
    ISO_OSDP_SCS_11 = 0x11, /* CHLNG */
    ISO_OSDP_SCS_12 = 0x12, /* CCRYPT */
    ISO_OSDP_SCS_13 = 0x13, /* SCRYPT */
    ISO_OSDP_SCS_14 = 0x14, /* RMAC_I */
    ISO_OSDP_SCS_15 = 0x15, /* command with a MAC, not encrypted */
    ISO_OSDP_SCS_16 = 0x16, /* reply with a MAC, not encrypted */
    ISO_OSDP_SCS_17 = 0x17, /* command with a MAC, its data encrypted */
    ISO_OSDP_SCS_18 = 0x18, /* reply with a MAC, its data encrypted */
};

enum iso_osdp_color {
    ISO_OSDP_BLACK = 0, /* off */
    ISO_OSDP_RED,
    ISO_OSDP_GREEN,
    ISO_OSDP_AMBER,
    ISO_OSDP_BLUE,
    ISO_OSDP_MAGENTA,
    ISO_OSDP_CYAN,
    ISO_OSDP_WHITE,
    ISO_OSDP_COLORS,
};

#endif
