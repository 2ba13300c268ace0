/* Two threads write the same number: what finds races must find this one, or its silence says nothing. */
#include <stdio.h>

int main(void)
{
    long sum = 0;
#pragma omp parallel for num_threads(4)
    for (long i = 0; i < 100000; i++)
        sum += i;
    printf("%ld\n", sum);
    return 0;
}
