/** @file
 * A fault: a line of text for people, which names a thing and says what is wrong with it, and a
 * number for programs, which says what kind of fault it is. */
#ifndef ISOTHERM_FAULT_H
#define ISOTHERM_FAULT_H

/** The description of a failure. A function that can fail returns a negative number of errno.h and
 * writes the description into a struct of the caller. The struct owns nothing, so it need not be
 * freed. A function that succeeds leaves it as it was. */
struct iso_fault {
    char text[256]; /**< One line without a newline, in UTF-8, ended by a zero byte. */
    unsigned code;  /**< The kind of fault; 0 if it has no number. The numbers are not stable. */
};

#endif
