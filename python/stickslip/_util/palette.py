"""Colours of all figures, by Okabe and Ito (2008): told apart with every kind of colour vision."""

BLACK = "#000000"
ORANGE = "#E69F00"
SKY = "#56B4E9"
GREEN = "#009E73"
YELLOW = "#F0E442"
BLUE = "#0072B2"
VERMILION = "#D55E00"
PURPLE = "#CC79A7"

# For lines and areas in the background; not of their palette.
GREY = "#999999"
DARK_GREY = "#777777"
LIGHT_GREY = "#DDDDDD"
