/* cmd/signals.h -- SIGINT, SIGTERM, SIGHUP (the terminal is gone) and SIGUSR1 (which mpirun and batch systems pass
 * on) as a request to end; one that was ignored when the program was started stays ignored.
 *
 * The first one is only noted, for signals_asked to tell; a second one of any kind ends the program at once, unless
 * it comes within 0.2 s of the first (`timeout` signals the process and then its group). Also SIGXFSZ, a file beyond
 * the allowed size, is from then on a failed write instead of the end.
 *
 * Threads  signals_asked may be called from any. */
#pragma once

void signals_catch(void);
int signals_asked(void *unused); /* the signal's number, 0: none came */
