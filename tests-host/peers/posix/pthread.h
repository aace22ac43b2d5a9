/* Locks for RTKLIB's header, whose types newlib has; nothing here runs beside anything. */
#ifndef POSIX_PTHREAD_H
#define POSIX_PTHREAD_H
#include <sys/types.h>
#define pthread_mutex_init(mutex, attributes) ((void)0)
#define pthread_mutex_lock(mutex) ((void)0)
#define pthread_mutex_unlock(mutex) ((void)0)
#endif
